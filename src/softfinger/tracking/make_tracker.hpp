#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "softfinger/geometry/trajectory.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// X_WFt of a finger that somebody moves, before anybody did: the first of `waypoints`, or 30 mm
/// above the origin.
[[nodiscard]] Pose start_pose(const std::vector<Waypoint>& waypoints);

/// The tracker that `spec` (see TrackerSpec) names. FILE is relative to
/// `base_directory`: the scene file's where the scene names the tracker, empty for the command
/// line. `waypoints` (X_WFt) serve "script"; trackers that others send poses to are at start_pose,
/// not valid, until one comes; "csv" ignores them. "webxr" of a whole hand is its index finger.
/// Throws InputError: an unknown kind, no waypoints, a file that cannot be read, a port that is in
/// use, a server that is silent or tracks no such body.
[[nodiscard]] std::unique_ptr<Tracker> make_tracker(std::string_view spec,
                                                    const std::filesystem::path& base_directory,
                                                    const std::vector<Waypoint>& waypoints);

}  // namespace softfinger
