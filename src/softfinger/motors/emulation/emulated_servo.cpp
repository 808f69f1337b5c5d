#include "softfinger/motors/emulation/emulated_servo.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {

void ServoMotion::start(const EmulatedServo& servo) {
  servo_ = servo;
  position_ = servo.initial_setpoint;
  velocity_ = 0.0;
}

void ServoMotion::move(double target) {
  const double position = setpoint();
  const double w = servo_.natural_frequency;
  const double error = target * servo_.step - position;
  velocity_ += kStep * (w * w * error - 2.0 * w * velocity_);
  const double rate = limit_ > 0.0 ? std::min(limit_, servo_.rate) : servo_.rate;
  velocity_ = std::clamp(velocity_, -rate, rate);
  position_.store(position + kStep * velocity_, std::memory_order_relaxed);
}

int ServoClock::steps_to(double time) {
  const auto due =
      static_cast<std::int64_t>(std::floor(std::min(time, 1e12) / ServoMotion::kStep + 1e-6));
  // Servos stand still long before this; a leap in time must not take its length in steps.
  constexpr std::int64_t kMostSteps = 10'000;
  const std::int64_t from = std::max(steps_, due - kMostSteps);
  steps_ = std::max(steps_, due);
  return static_cast<int>(steps_ - from);
}

SimulatedServos::SimulatedServos(std::span<const EmulatedServo> servos) : motions_(servos.size()) {
  for (std::size_t i = 0; i < servos.size(); ++i) {
    motions_[i].start(servos[i]);
    targets_.push_back(std::round(servos[i].initial_setpoint / servos[i].step));
  }
}

void SimulatedServos::receive(std::span<const std::int32_t> targets) {
  std::copy(targets.begin(), targets.end(), targets_.begin());
}

void SimulatedServos::advance_to(double time) {
  for (int step = clock_.steps_to(time); step > 0; --step) {
    for (std::size_t i = 0; i < motions_.size(); ++i) motions_[i].move(targets_[i]);
  }
}

}  // namespace softfinger
