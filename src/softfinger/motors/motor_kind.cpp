#include "softfinger/motors/motor_kind.hpp"

#include <fmt/core.h>

namespace softfinger {

std::string key_with_unit(const MotorKind& kind, std::string_view key) {
  return kind.unit.empty() ? std::string(key) : fmt::format("{}_{}", key, kind.unit);
}

std::string slope_key(const MotorKind& kind, bool linear_joints) {
  const std::string_view per = linear_joints || kind.follows_travel ? "per_mm" : "per_deg";
  return kind.unit.empty() ? std::string(per) : fmt::format("{}_{}", kind.unit, per);
}

double read_slope(const ConfigTable& table, const std::string& key) {
  const double slope = table.number(key);
  if (slope == 0.0) table.fail(key, "must not be 0: the servo would not move");
  return slope;
}

}  // namespace softfinger
