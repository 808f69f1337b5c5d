#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "softfinger/geometry/trajectory.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// The tracker that `spec` (see TrackerSpec) names. FILE is relative to
/// `base_directory`: the scene file's where the scene names the tracker, empty for the command
/// line. `waypoints` (X_WFt) serve "script"; "page" starts at the first, or 30 mm above the origin;
/// others ignore them. Throws InputError: an unknown kind, no waypoints, a file that cannot be
/// read, a port that is in use.
[[nodiscard]] std::unique_ptr<Tracker> make_tracker(std::string_view spec,
                                                    const std::filesystem::path& base_directory,
                                                    const std::vector<Waypoint>& waypoints);

}  // namespace softfinger
