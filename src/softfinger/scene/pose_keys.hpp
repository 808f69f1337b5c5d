#pragma once

#include <vector>

#include "softfinger/files/config_file.hpp"
#include "softfinger/geometry/trajectory.hpp"

namespace softfinger {

// Keys that fingers and objects of a scene file share.

/// position_mm and rotation_vector_deg. The second may be left out, and the first where `fallback`
/// has one.
[[nodiscard]] Pose read_pose(const ConfigTable& table, const Pose* fallback);

/// `[[waypoint]]` tables; `fallback`: the pose an object has where a waypoint does not say.
[[nodiscard]] std::vector<Waypoint> read_waypoints(const ConfigTable& owner, const Pose* fallback);

}  // namespace softfinger
