#pragma once

#include <vector>

#include "softfinger/wearer/press_reading.hpp"

namespace softfinger {

/// How late a force sensor is: as a device leaves the skin within a tick or two, what is said
/// longer than it can be felt comes late.
class SensorDelay {
 public:
  /// The device leaves the skin: the force there was, N, and how it grew with advance, N/m; where,
  /// m; and at which speed it came there, m/s.
  void leave(double force, double slope, double advance, double speed);
  /// What is said after that where the device stands, m and N, zero not taken off.
  void watch(double advance, double said);
  /// The press it left counts.
  void keep();
  /// Of a sensor that says `zero` (N) off the skin, in s, where a reading comes each `tick` (s):
  /// the mean over the presses but for the two furthest off, in which the wearer may have moved; 0
  /// where none counts.
  [[nodiscard]] double mean(double zero, double tick) const;

 private:
  struct Fall {
    double force = 0.0, slope = 0.0, from = 0.0, speed = 0.0;
    double beyond = 0.0,
           readings = 0.0;  ///< sum of what was said beyond what was felt, N; of so many
  };
  [[nodiscard]] static double ticks_of(const Fall& fall, double zero, double tick);

  Fall fall_;
  std::vector<Fall> falls_;  ///< by press
};

/// What was read is what was felt `delay` (s) before.
void take_delay_off(double delay, std::vector<PressRecord>& presses);

}  // namespace softfinger
