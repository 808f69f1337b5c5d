#include "softfinger/motors/servo_map.hpp"

#include <algorithm>

namespace softfinger {
namespace {

// A limit that is a whole number of steps stays one, whatever the last bit of it.
constexpr double kRounding = 1e-6;

}  // namespace

double ServoMap::setpoint(double joint) const {
  return std::clamp(settings_.zero + settings_.per_radian * joint, settings_.min, settings_.max);
}

double ServoMap::joint(double setpoint) const {
  return (setpoint - settings_.zero) / settings_.per_radian;
}

std::int32_t ServoMap::target(double joint, double min_joint, double max_joint) const {
  const auto [low, high] = std::minmax({setpoint(min_joint), setpoint(max_joint)});
  const double first = std::ceil(low / settings_.step - kRounding);
  const double last = std::floor(high / settings_.step + kRounding);
  const double nearest = std::round(setpoint(joint) / settings_.step);
  return static_cast<std::int32_t>(std::clamp(nearest, std::min(first, last), last));
}

}  // namespace softfinger
