#include "softfinger/twin/motor_torque.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Of motors that are said not to yield: less than anything that the finger tells.
constexpr double kStiffest = 1e-5 * deg / 1e-3;      // rad by N m
constexpr double kStiffestLinear = 1e-5 * mm / 1.0;  // m by N

}  // namespace

MotorTorque motor_torque(const MotorStatics& statics, bool linear, double error) {
  const double compliance = std::max(statics.compliance, linear ? kStiffestLinear : kStiffest);
  const double beyond = std::abs(error) - 0.5 * statics.backlash;
  if (beyond < 0.0) return {};
  const double torque = beyond / compliance;
  if (statics.holding > 0.0 && torque >= statics.holding) {
    return {std::copysign(statics.holding, error), 0.0, true};
  }
  return {std::copysign(torque, error), 1.0 / compliance, false};
}

}  // namespace softfinger
