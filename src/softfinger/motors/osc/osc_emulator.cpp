#include "softfinger/motors/osc/osc_emulator.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/wire/osc.hpp"

namespace softfinger {

OscEmulator::OscEmulator(const TransportSettings& transport, std::span<const EmulatedServo> servos)
    : servos_(servos.size()) {
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    servos_[i].address = transport.servos[i].address;
    servos_[i].motion.start(servos[i]);
    servos_[i].wanted = servos[i].initial_setpoint;
  }
}

bool OscEmulator::read(std::span<const std::uint8_t> datagram) {
  numbers_.clear();
  const bool whole = is_osc_bundle(datagram) && read_osc(datagram, [&](const OscMessage& message) {
                       const std::size_t servo = numbers_.size();
                       double number = 0.0;
                       numbers_.push_back(0.0);
                       if (servo >= servos_.size() || message.address != servos_[servo].address ||
                           message.types != "f" || !message.read({&number, 1})) {
                         return false;
                       }
                       numbers_.back() = number;
                       return std::isfinite(number);
                     });
  return whole && numbers_.size() == servos_.size();
}

void OscEmulator::receive(std::span<const std::uint8_t> datagram) {
  if (!read(datagram)) {
    ++malformed_;
    return;
  }
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    Servo& servo = servos_[i];
    servo.wanted = numbers_[i];
    servo.least = std::min(servo.least.load(), servo.wanted);
    servo.largest = std::max(servo.largest.load(), servo.wanted);
  }
  ++bundles_;
}

void OscEmulator::advance_to(double time) {
  for (int step = clock_.steps_to(time); step > 0; --step) {
    for (Servo& servo : servos_) servo.motion.move(servo.wanted / servo.motion.servo().step);
  }
}

}  // namespace softfinger
