#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

namespace softfinger {

/// A servo as simulated: a critically damped second-order position loop with a largest speed, all
/// in set points of the transport (ServoSettings).
struct EmulatedServo {
  int channel = 0;                   ///< of a Maestro; id on a bus
  double initial_setpoint = 1.5e-3;  ///< where it stands before the first command
  double rate = 4e-3;                ///< set point per s; its largest speed
  double natural_frequency = 60.0;   ///< rad/s of the position loop
  double step = 0.25e-6;             ///< set point of one step of the wire
};

/// Where one simulated servo is. One thread moves it, any may ask.
class ServoMotion {
 public:
  static constexpr double kStep = 1e-3;  ///< s

  ServoMotion() = default;
  explicit ServoMotion(const EmulatedServo& servo) { start(servo); }
  void start(const EmulatedServo& servo);
  /// kStep further, towards a target in steps of the wire.
  void move(double target);
  /// Its controller lets it move no faster, set point per s; 0: as fast as it can.
  void limit_rate(double rate) { limit_ = rate; }
  /// Without power it stays where it is.
  void rest() { velocity_ = 0.0; }
  [[nodiscard]] double setpoint() const { return position_.load(std::memory_order_relaxed); }
  [[nodiscard]] const EmulatedServo& servo() const { return servo_; }

 private:
  EmulatedServo servo_;
  std::atomic<double> position_{0.0};
  double velocity_ = 0.0;  ///< set point per s
  double limit_ = 0.0;     ///< see limit_rate()
};

/// Whole steps of ServoMotion that are due as time passes.
class ServoClock {
 public:
  /// Steps to `time` (s from the start) that were not due before; an earlier time gives none.
  int steps_to(double time);

 private:
  std::int64_t steps_ = 0;
};

/// The servos of a device without a bus, in simulated time: targets reach them at once.
class SimulatedServos {
 public:
  explicit SimulatedServos(std::span<const EmulatedServo> servos);
  /// Targets of the last command, from now on.
  void receive(std::span<const std::int32_t> targets);
  /// Moves the servos up to `time`, s from the start.
  void advance_to(double time);
  [[nodiscard]] double setpoint(std::size_t servo) const { return motions_[servo].setpoint(); }

 private:
  std::vector<ServoMotion> motions_;
  std::vector<double> targets_;
  ServoClock clock_;
};

}  // namespace softfinger
