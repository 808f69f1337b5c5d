#pragma once

#include <cstdint>

#include "softfinger/device/transport_settings.hpp"

namespace softfinger {

/// Unit of the wire: targets are counted in quarter microseconds of pulse width (s).
inline constexpr double kQuarterMicrosecond = 0.25e-6;

/// Joint angle (rad) and pulse width (s) of one servo: pulse = zero + per_radian * angle, cut to
/// the shortest and longest pulse.
class ServoMap {
 public:
  explicit ServoMap(const ServoSettings& settings) : settings_(settings) {}

  [[nodiscard]] int channel() const { return settings_.channel; }
  [[nodiscard]] double pulse(double joint) const;
  /// Joint angle at which the servo rests for a pulse; pulses beyond the cut are taken as they are.
  [[nodiscard]] double joint(double pulse) const;
  /// Joint angle of one quarter microsecond, > 0.
  [[nodiscard]] double resolution() const;

  /// Nearest target whose joint angle lies within [min_joint, max_joint] (rad) and whose pulse lies
  /// within the cut: rounding never carries a command over a limit.
  [[nodiscard]] std::uint16_t target(double joint, double min_joint, double max_joint) const;
  [[nodiscard]] double joint_of_target(double target) const {
    return joint(target * kQuarterMicrosecond);
  }

 private:
  ServoSettings settings_;
};

}  // namespace softfinger
