#include "softfinger/motors/maestro/maestro_bus.hpp"

#include <fmt/core.h>

#include <array>

#include "softfinger/base/error.hpp"
#include "softfinger/motors/maestro/maestro_protocol.hpp"

namespace softfinger {

MaestroBus::MaestroBus(const TransportSettings& transport)
    : baud_(static_cast<unsigned>(transport.baud)) {
  for (const ServoSettings& servo : transport.servos) {
    if (servo.channel < 0 || servo.channel >= kMaestroChannels) {
      throw InputError(fmt::format("transport.servo.channel: {} is none of a Maestro's 0 to {}",
                                   servo.channel, kMaestroChannels - 1));
    }
    channels_.push_back(servo.channel);
  }
}

std::string MaestroBus::open(const std::string& port) {
  std::string reason = port_.open(port, baud_);
  port_.discard_input();
  return reason;
}

bool MaestroBus::write(std::span<const std::int32_t> targets) noexcept {
  std::array<std::uint8_t, 4 * kMaestroChannels> bytes;
  std::size_t size = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto target = static_cast<std::uint16_t>(targets[i]);
    for (const std::uint8_t byte : encode_set_target(channels_[i], target)) bytes[size++] = byte;
  }
  return port_.write(std::span(bytes).first(size)) == SerialPort::Result::kSent;
}

bool MaestroBus::ask() noexcept {
  std::array<std::uint8_t, 2 * kMaestroChannels> question;
  std::size_t size = 0;
  for (const int channel : channels_) {
    for (const std::uint8_t byte : encode_get_position(channel)) question[size++] = byte;
  }
  port_.write(std::span(question).first(size));
  return true;
}

bool MaestroBus::take_positions(std::span<std::int32_t> positions) noexcept {
  std::array<std::uint8_t, 16 * 2 * kMaestroChannels> answer;
  // Several whole answers came late, and the last one counts; anything else is noise of the line.
  const std::size_t size = 2 * channels_.size();
  const std::size_t got = port_.read(answer);
  if (got == 0 || got % size != 0) return false;
  const auto last = std::span(answer).subspan(got - size, size);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    positions[i] = decode_reply(last[2 * i], last[2 * i + 1]);
    if (positions[i] == 0) return false;  // no pulses: the servo may be anywhere
  }
  return true;
}

}  // namespace softfinger
