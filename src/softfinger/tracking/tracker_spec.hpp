#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "softfinger/geometry/trajectory.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// The tracker that `spec` ("script" or "csv:FILE") names. FILE is relative to `base_directory`:
/// the scene file's where the scene names the tracker, empty for the command line. `waypoints`
/// (X_WFt) serve "script" and are ignored by others. Throws InputError: an unknown kind, no
/// waypoints, a file that cannot be read.
[[nodiscard]] std::unique_ptr<Tracker> make_tracker(std::string_view spec,
                                                    const std::filesystem::path& base_directory,
                                                    const std::vector<Waypoint>& waypoints);

}  // namespace softfinger
