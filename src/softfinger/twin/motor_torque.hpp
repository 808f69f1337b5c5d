#pragma once

#include "softfinger/device/motor_statics.hpp"

namespace softfinger {

/// What a motor does against an error of its joint.
struct MotorTorque {
  double torque = 0.0;     ///< N m, or N
  double rate = 0.0;       ///< by the error
  bool gives_way = false;  ///< it can hold no more
};

/// Of a motor whose joint is `error` (rad, or m) beyond where it was sent: nothing within its play,
/// then as stiff as its compliance says, at most what it holds.
[[nodiscard]] MotorTorque motor_torque(const MotorStatics& statics, bool linear, double error);

}  // namespace softfinger
