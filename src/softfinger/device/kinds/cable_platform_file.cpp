#include <fmt/core.h>

#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/cable_platform.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/surfaces/disk_surface.hpp"

namespace softfinger {

std::shared_ptr<const Device> read_cable_platform(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable lengths = file.root().table("geometry");
  CablePlatformGeometry geometry;
  geometry.base_radius = lengths.number("base_radius_mm", Range::positive());
  geometry.platform_radius = lengths.number("platform_radius_mm", Range::positive());
  geometry.neutral_height = lengths.number("neutral_height_mm", Range::positive());
  geometry.winch_radius = lengths.number("winch_radius_mm", Range::positive());
  geometry.spring_length = lengths.number("spring_length_mm", Range::positive());
  geometry.spring_stiffness = lengths.number("spring_N_per_mm", Range::positive());
  geometry.spring_bending =
      lengths.number("spring_bending_N_mm_per_rad", Range::at_least(0.0), 0.0);
  geometry.disk_radius = lengths.number("disk_radius_mm", Range::positive());
  geometry.disk_edge_radius = read_disk_edge_radius(lengths, geometry.disk_radius);
  const ConfigTable limits = file.root().table("limits");
  settings.joint_limits = read_joint_limits(limits, 3);
  geometry.max_tilt = read_max_tilt(limits);
  geometry.least_tension = limits.number("least_tension_N", Range::positive(), 0.02);

  settings.axes = CablePlatform::axes_for(geometry);
  read_shared_tables(file, settings);
  auto kinematics = std::make_unique<const CablePlatform>(settings, geometry);
  check_rest_poses(file, settings, [&](const Configuration& q) -> std::string {
    const double tilt = std::hypot(q[0], q[1]);
    if (tilt > geometry.max_tilt + 1e-9) {
      return fmt::format("tilt of {:.4g} degrees is more than limits.max_tilt_deg {:g}", tilt / deg,
                         geometry.max_tilt / deg);
    }
    std::string obstacle = joint_obstacle(*kinematics, q);
    if (!obstacle.empty()) return obstacle;
    Vector3 tension;
    Eigen::Index cable = 0;
    if (!kinematics->tensions(q, tension)) return "no cable tensions balance the spring";
    if (tension.minCoeff(&cable) < geometry.least_tension - 1e-9) {
      return fmt::format(
          "cable {} would have to push: its tension is {:.3g} N, less than limits.least_tension_N "
          "{:g} (check spring_length_mm, neutral_height_mm and the radii)",
          cable + 1, tension[cable], geometry.least_tension);
    }
    return axis_obstacle(*kinematics, q);
  });
  return std::make_shared<const Device>(
      std::move(settings), std::move(kinematics),
      std::make_unique<const DiskSurface>(geometry.disk_radius, geometry.disk_edge_radius));
}

}  // namespace softfinger
