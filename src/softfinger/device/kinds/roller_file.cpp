#include <algorithm>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/linear_drives.hpp"
#include "softfinger/device/surfaces/roller_surface.hpp"

namespace softfinger {

// q = (position along x, height of the crest over z = 0 of B'). After the contact location display
// of Provancher, Cutkosky, Kuchenbecker, Niemeyer, "Contact location display for haptic perception
// of curvature and object motion", Int. J. Robotics Research 24, 2005.
std::shared_ptr<const Device> read_roller(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable sizes = file.root().table("geometry");
  RollerGeometry geometry;
  geometry.roller_radius = sizes.number("roller_radius_mm", Range::positive());
  geometry.roller_length = sizes.number("roller_length_mm", Range::positive());
  const double most = std::min(geometry.roller_radius, 0.5 * geometry.roller_length);
  geometry.roller_edge_radius =
      sizes.number("roller_edge_radius_mm", Range::at_least(0.0), std::min(0.5 * mm, most));
  if (geometry.roller_edge_radius > most) {
    sizes.fail("roller_edge_radius_mm",
               "must be at most roller_radius_mm and half of roller_length_mm");
  }
  const ConfigTable limits = file.root().table("limits");
  const Interval position = read_interval(limits, "position_mm");
  const Interval height = read_interval(limits, "height_mm");
  geometry.min_position = position.min;
  geometry.max_position = position.max;
  geometry.min_height = height.min;
  geometry.max_height = height.max;

  settings.axes = {
      ConfigurationAxis::length("position_mm", geometry.min_position, geometry.max_position),
      ConfigurationAxis::length("height_mm", geometry.min_height, geometry.max_height)};
  LinearDrives::set_joint_limits(settings, read_linear_rate(limits));
  read_shared_tables(file, settings);
  auto kinematics = std::make_unique<const LinearDrives>(
      settings, std::vector<Vector3>{Vector3::UnitX(), Vector3::UnitZ()}, 1);
  check_rest_poses(file, settings,
                   [&](const Configuration& q) { return axis_obstacle(*kinematics, q); });
  return std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                        std::make_unique<const RollerSurface>(geometry));
}

}  // namespace softfinger
