#include <fmt/core.h>

#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/kinds/platform_3rrs.hpp"

namespace softfinger {
namespace {

/// Why q is out of the workspace, in words; empty if it is inside.
std::string platform_3rrs_obstacle(const Platform3rrs& kinematics, const Configuration& q) {
  const double tilt = std::hypot(q[0], q[1]);
  const double max_tilt = kinematics.geometry().max_tilt;
  if (tilt > max_tilt + 1e-9) {
    return fmt::format("tilt of {:.4g} degrees is more than limits.max_tilt_deg {:g}", tilt / deg,
                       max_tilt / deg);
  }
  JointAngles joints;
  if (!kinematics.inverse_kinematics(q, joints)) {
    return "the legs do not reach: no inverse kinematics (check crank_mm, coupler_mm, "
           "neutral_height_mm and the radii)";
  }
  std::string joint = joint_obstacle(kinematics, q);
  if (!joint.empty()) return joint;
  // Length of the crank times a change of joint per change of q, about 1 in a sound design.
  if (std::abs(kinematics.home_determinant()) < 1e-3) return "the platform is singular there";
  if (!kinematics.reachable(q)) return "no way leads there from home without passing a limit";
  return {};
}

}  // namespace

std::shared_ptr<const Device> read_platform_3rrs(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable lengths = file.root().table("geometry");
  Platform3rrsGeometry geometry;
  geometry.base_radius = lengths.number("base_radius_mm", Range::positive());
  geometry.platform_radius = lengths.number("platform_radius_mm", Range::positive());
  geometry.crank = lengths.number("crank_mm", Range::positive());
  geometry.coupler = lengths.number("coupler_mm", Range::positive());
  geometry.neutral_height = lengths.number("neutral_height_mm", Range::positive());
  geometry.disk_radius = lengths.number("disk_radius_mm", Range::positive());
  geometry.disk_edge_radius = read_disk_edge_radius(lengths, geometry.disk_radius);

  const ConfigTable limits = file.root().table("limits");
  settings.joint_limits = read_joint_limits(limits, 3);
  geometry.max_tilt = read_max_tilt(limits);

  settings.axes = Platform3rrs::axes_for(geometry.disk_radius);
  read_shared_tables(file, settings);
  auto device = make_platform_3rrs(std::move(settings), geometry);
  const auto& kinematics = static_cast<const Platform3rrs&>(device->kinematics());
  check_rest_poses(file, device->settings(),
                   [&](const Configuration& q) { return platform_3rrs_obstacle(kinematics, q); });
  return device;
}

}  // namespace softfinger
