#include "softfinger/actuation/servo_map.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/actuation/maestro_protocol.hpp"

namespace softfinger {
namespace {

// A limit that is a whole number of quarter microseconds stays one, whatever the last bit of it.
constexpr double kRounding = 1e-6;

}  // namespace

double ServoMap::pulse(double joint) const {
  return std::clamp(settings_.zero + settings_.per_radian * joint, settings_.min, settings_.max);
}

double ServoMap::joint(double pulse) const {
  return (pulse - settings_.zero) / settings_.per_radian;
}

double ServoMap::resolution() const { return kQuarterMicrosecond / std::abs(settings_.per_radian); }

std::uint16_t ServoMap::target(double joint, double min_joint, double max_joint) const {
  const auto [low, high] = std::minmax({pulse(min_joint), pulse(max_joint)});
  const double first = std::ceil(low / kQuarterMicrosecond - kRounding);
  const double last = std::min(std::floor(high / kQuarterMicrosecond + kRounding),
                               static_cast<double>(kMaestroMaxValue));
  const double nearest = std::round(pulse(joint) / kQuarterMicrosecond);
  return static_cast<std::uint16_t>(std::clamp(nearest, std::min(first, last), last));
}

}  // namespace softfinger
