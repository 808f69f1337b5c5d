#pragma once

#include <functional>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// Where a platform with pitch, roll and travel goes; rad and m.
struct PlatformSpace {
  std::function<bool(double pitch, double roll, double travel)> reachable;
  double low = 0.0, high = 0.0;  ///< travel is looked for between these
  double home_travel = 0.0;      ///< and near this
  double max_tilt = 0.0;
};

/// Measures the workspace of a platform: travel at zero tilt (the interval nearest home_travel),
/// the least over directions of the tilt reached from zero at mid travel, and the largest tilt
/// found anywhere.
[[nodiscard]] WorkspaceSummary summarise_platform_workspace(const PlatformSpace& space);

/// The same more coarsely, in layers of travel; which axes these are is the caller's.
[[nodiscard]] WorkspaceOutline outline_platform_workspace(const PlatformSpace& space);

}  // namespace softfinger
