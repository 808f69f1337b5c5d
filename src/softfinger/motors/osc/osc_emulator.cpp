#include "softfinger/motors/osc/osc_emulator.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/motors/osc/osc_bundle.hpp"

namespace softfinger {

OscEmulator::OscEmulator(const TransportSettings& transport, std::span<const EmulatedServo> servos)
    : servos_(servos.size()) {
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    servos_[i].address = transport.servos[i].address;
    servos_[i].motion.start(servos[i]);
    servos_[i].wanted = servos[i].initial_setpoint;
  }
}

void OscEmulator::receive(std::span<const std::uint8_t> datagram) {
  const auto messages = decode_osc_bundle(datagram);
  const auto fits = [&] {
    if (!messages || messages->size() != servos_.size()) return false;
    for (std::size_t i = 0; i < servos_.size(); ++i) {
      if ((*messages)[i].address != servos_[i].address) return false;
      if (!std::isfinite((*messages)[i].value)) return false;
    }
    return true;
  };
  if (!fits()) {
    ++malformed_;
    return;
  }
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    Servo& servo = servos_[i];
    servo.wanted = static_cast<double>((*messages)[i].value);
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
