#include "softfinger/scene/pose_keys.hpp"

#include <fmt/format.h>

namespace softfinger {
namespace {

// Ranges in the units of the file: beyond them a number is a slip of the pen, and arithmetic on it
// would lose the micrometres that contact lives on.
const Range kPosition = Range::between(-1e5, 1e5);  // mm
const Range kRotation = Range::between(-1e4, 1e4);  // deg
const Range kTime = Range::between(0.0, 1e6);       // s

}  // namespace

Pose read_pose(const ConfigTable& table, const Pose* fallback) {
  Pose pose;
  if (fallback == nullptr) {
    pose.translation = table.numbers("position_mm", 3, kPosition);
  } else {
    pose.translation = table.numbers("position_mm", 3, kPosition, fallback->translation);
  }
  if (fallback != nullptr && !table.has("rotation_vector_deg")) {
    (void)table.numbers("rotation_vector_deg", 3, kRotation,
                        log_rotation(fallback->rotation));  // for the file as read
    pose.rotation = fallback->rotation;
  } else {
    const Vector3 turn = table.numbers("rotation_vector_deg", 3, kRotation, Vector3::Zero());
    pose.rotation = exp_rotation(turn);
  }
  return pose;
}

std::vector<Waypoint> read_waypoints(const ConfigTable& owner, const Pose* fallback) {
  std::vector<Waypoint> waypoints;
  for (const ConfigTable& table : owner.tables("waypoint")) {
    const double time = table.number("time_s", kTime);
    if (!waypoints.empty() && !(time > waypoints.back().time)) {
      table.fail("time_s", fmt::format("times of waypoints must increase, found {} after {}", time,
                                       waypoints.back().time));
    }
    waypoints.push_back({time, read_pose(table, fallback)});
  }
  return waypoints;
}

}  // namespace softfinger
