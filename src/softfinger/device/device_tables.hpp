#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/device/kinematics.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {

// The tables of a device file that every kind has. A kind's reader asks for its own keys, fills in
// axes and joint limits, reads the shared tables, builds the device and checks where it rests.

// Beyond these a number of a file, in its unit, is a slip of the pen.
inline const Range kPlaceRange = Range::between(-1000.0, 1000.0);  ///< mm
inline const Range kTurnRange = Range::between(-360.0, 360.0);     ///< deg

/// `joint_deg` and `joint_rate_deg_per_s` of `[limits]`, the same for all `joints`.
[[nodiscard]] JointLimits read_joint_limits(const ConfigTable& limits, int joints);

/// `name` = [least, largest] of `[limits]`, within `range`.
struct Interval {
  double min = 0.0, max = 0.0;
};
[[nodiscard]] Interval read_interval(const ConfigTable& limits, std::string_view name,
                                     Range range = Range::any());

/// `joint_rate_mm_per_s` of `[limits]`, m/s; 50 mm/s where not given.
[[nodiscard]] double read_linear_rate(const ConfigTable& limits);

/// `disk_edge_radius_mm` of `[geometry]`: 0.5 mm, at most half the disk's 2 mm and its radius.
[[nodiscard]] double read_disk_edge_radius(const ConfigTable& geometry, double disk_radius);

/// `max_tilt_deg` of `[limits]`, 30 degrees where not given.
[[nodiscard]] double read_max_tilt(const ConfigTable& limits);

/// Reads what every kind has into settings whose axes and joint limits are set: mount, home,
/// retract, largest force, matching, transport. Ends the reading: keys that nobody asked for are
/// refused.
void read_shared_tables(const ConfigFile& file, DeviceSettings& settings);

/// Refuses a home or a retracted pose out of the workspace. `obstacle` says in words why a
/// configuration is; empty if it is inside.
void check_rest_poses(const ConfigFile& file, const DeviceSettings& settings,
                      const std::function<std::string(const Configuration& q)>& obstacle);

/// Which component of q would be out of the limits of its axis, in words; empty if none.
[[nodiscard]] std::string axis_obstacle(const Kinematics& kinematics, const Configuration& q);

/// Which joint of q would be out of its limits, in words; empty if none or where the linkage does
/// not close.
[[nodiscard]] std::string joint_obstacle(const Kinematics& kinematics, const Configuration& q);

/// Index of the name that `key` has in `names`; refused, with the nearest, where there is none.
/// `what`: "body", "joint".
[[nodiscard]] int read_name(const ConfigTable& table, const std::string& key,
                            const std::vector<std::string>& names, const std::string& what);
/// A pose of keys that end in `suffix`: origin_mm and rotation_vector_deg, or origin_a_mm and
/// rotation_vector_a_deg.
[[nodiscard]] Pose read_frame(const ConfigTable& table, const std::string& suffix = {});
/// A direction of any length but 0, as a unit vector.
[[nodiscard]] Vector3 read_axis(const ConfigTable& table, const std::string& key,
                                const Vector3& fallback);

}  // namespace softfinger
