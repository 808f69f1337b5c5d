#pragma once

#include <functional>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// Measures the workspace of a platform with q = (pitch, roll, travel): travel at zero tilt (the
/// interval nearest home_travel, searched in [low, high]), the least over directions of the tilt
/// reached from zero at mid travel, the largest tilt found anywhere, and layers of tilts. rad and m.
/// Which axes these are is the caller's.
[[nodiscard]] WorkspaceSummary summarise_platform_workspace(
    const std::function<bool(double pitch, double roll, double travel)>& reachable, double low,
    double high, double home_travel, double max_tilt);

}  // namespace softfinger
