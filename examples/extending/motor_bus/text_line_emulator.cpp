#include "text_line_emulator.hpp"

#include <cmath>

#include "text_line_bus.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kLongestLine = 250;

}  // namespace

TextLineEmulator::TextLineEmulator(std::span<const EmulatedServo> servos)
    : motions_(servos.size()), read_(servos.size()) {
  for (std::size_t i = 0; i < servos.size(); ++i) {
    motions_[i].start(servos[i]);
    targets_.push_back(
        static_cast<std::int32_t>(std::lround(servos[i].initial_setpoint / servos[i].step)));
  }
}

void TextLineEmulator::receive(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte != '\n') {
      if (line_.size() < kLongestLine) line_ += static_cast<char>(byte);
      continue;
    }
    read_line();
    line_.clear();
  }
}

void TextLineEmulator::read_line() {
  if (line_ == "?") {
    answer();
  } else if (read_text_line(line_, 'm', read_)) {
    targets_ = read_;
  }
}

void TextLineEmulator::answer() {
  std::string text = "p";
  for (const ServoMotion& motion : motions_) {
    text += ' ' + std::to_string(std::lround(motion.setpoint() / motion.servo().step));
  }
  text += '\n';
  replies_.add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void TextLineEmulator::advance_to(double time) {
  for (int step = clock_.steps_to(time); step > 0; --step) {
    for (std::size_t i = 0; i < motions_.size(); ++i) motions_[i].move(targets_[i]);
  }
}

}  // namespace softfinger
