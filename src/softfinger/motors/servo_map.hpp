#pragma once

#include <cmath>
#include <cstdint>

#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// Joint angle (rad) and set point of one servo: set point = zero + per_radian * angle, cut to the
/// least and the largest. What goes over the wire is a target, a whole number of steps.
class ServoMap {
 public:
  explicit ServoMap(const ServoSettings& settings) : settings_(settings) {}

  [[nodiscard]] int channel() const { return settings_.channel; }
  /// In the unit of the transport, see ServoSettings.
  [[nodiscard]] double setpoint(double joint) const;
  /// Joint angle at which the servo rests for a set point; those beyond the cut are taken as they
  /// are.
  [[nodiscard]] double joint(double setpoint) const;
  /// Joint angle of one step of the wire, > 0.
  [[nodiscard]] double resolution() const {
    return settings_.step / std::abs(settings_.per_radian);
  }

  /// Nearest target whose joint angle lies within [min_joint, max_joint] (rad) and whose set point
  /// lies within the cut: rounding never carries a command over a limit.
  [[nodiscard]] std::int32_t target(double joint, double min_joint, double max_joint) const;
  [[nodiscard]] double joint_of_target(double target) const {
    return joint(target * settings_.step);
  }

 private:
  ServoSettings settings_;
};

}  // namespace softfinger
