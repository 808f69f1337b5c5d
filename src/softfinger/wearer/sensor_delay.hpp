#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "softfinger/wearer/press_reading.hpp"

namespace softfinger {

/// How late a force sensor is: as a device leaves the skin within a tick or two, what is said
/// longer than it can be felt comes late. That skin gives less on the way back than it did on the
/// way there, and that gears with play leave it later, is left out: of the tick that most sensors
/// are late, the one is a tenth too little and 0.1 mm of the other as much too much.
class SensorDelay {
 public:
  /// A reading and how far the device was advanced then: m, N.
  struct Seen {
    double advance = 0.0, force = 0.0;
  };

  /// The device leaves the skin: what was said on the way there, zero taken off, and the speed of
  /// that, m/s.
  void leave(std::span<const Seen> press, double speed);
  /// What is said after that where the device stands, m and N, zero not taken off.
  void watch(double advance, double said);
  /// The press it left counts.
  void keep();
  /// Of a sensor that says `zero` (N) off the skin, in s, where a reading comes each `tick` (s):
  /// the mean over the presses but for the two furthest off, in which the wearer may have moved; 0
  /// where none counts.
  [[nodiscard]] double mean(double zero, double tick) const;

 private:
  /// A press: force by advance, as a parabola about its end, and what was said after.
  struct Fall {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, N/m, N/m^2
    double touch = 0.0, from = 0.0, speed = 0.0;      ///< m, m, m/s
    std::vector<Seen> after;

    /// N, where the sensor was `late` (s).
    [[nodiscard]] double felt(double advance, double late) const;
  };
  [[nodiscard]] double delay_of(const Fall& fall, double zero, double tick) const;

  Fall fall_;
  std::vector<Fall> falls_;  ///< by press
};

/// What is read was felt `delay` (s) before.
void take_delay_off(double delay, std::vector<PressRecord>& presses);

}  // namespace softfinger
