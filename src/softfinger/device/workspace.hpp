#pragma once

#include <functional>
#include <string>
#include <vector>

namespace softfinger {

/// How far an axis goes with the others at home.
struct AxisReach {
  std::string name;
  double min = 0.0, max = 0.0;  ///< SI
  double unit = 1.0;            ///< SI per unit of the name
};

/// Answer of `device workspace`.
struct WorkspaceSummary {
  /// Where there is no travel and tilt to tell of. Axes that are alike share one entry.
  std::vector<AxisReach> reaches;
  double min_travel = 0.0, max_travel = 0.0;  ///< at zero tilt, m
  double mid_travel = 0.0;                    ///< m
  double min_tilt_at_mid_travel = 0.0;        ///< least over directions, rad
  double max_tilt = 0.0;                      ///< largest anywhere in the workspace, rad
};

/// A workspace as it is drawn: layers of tilt where it tilts and travels, else reaches.
struct WorkspaceOutline {
  std::vector<AxisReach> reaches;
  /// Tilts reached from zero at one travel.
  struct TiltLayer {
    double travel = 0.0;        ///< m
    std::vector<double> tilts;  ///< rad; entry k of n in direction (pitch, roll) = 2 pi k / n
  };
  std::vector<TiltLayer> tilt_layers;  ///< from the least travel to the greatest
  /// Which axes pitch, roll and travel are; -1 where there is none.
  int pitch_axis = -1, roll_axis = -1, travel_axis = -1;
};

/// Which axes of a configuration pitch, roll and travel are; -1 where there is none.
struct PlatformAxes {
  int pitch = -1, roll = -1, travel = -1;
};

/// Where a platform with pitch, roll and travel goes; rad and m.
struct PlatformSpace {
  PlatformAxes axes;
  std::function<bool(double pitch, double roll, double travel)> reachable;
  double low = 0.0, high = 0.0;  ///< travel is looked for between these
  double home_travel = 0.0;      ///< and near this
  double max_tilt = 0.0;
};

/// Measures the workspace of a platform: travel at zero tilt (the interval nearest home_travel),
/// the least over directions of the tilt reached from zero at mid travel, and the largest tilt
/// found anywhere.
[[nodiscard]] WorkspaceSummary summarise_platform_workspace(const PlatformSpace& space);

/// The same more coarsely, in layers of travel.
[[nodiscard]] WorkspaceOutline outline_platform_workspace(const PlatformSpace& space);

}  // namespace softfinger
