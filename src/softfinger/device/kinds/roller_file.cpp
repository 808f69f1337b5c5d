#include <algorithm>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/kinds/roller.hpp"

namespace softfinger {

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

  settings.axes = Roller::axes_for(geometry);
  LinearDrives::set_joint_limits(settings, read_linear_rate(limits));
  read_shared_tables(file, settings);
  auto device = std::make_shared<const Roller>(std::move(settings), geometry);
  check_rest_poses(file, *device,
                   [&](const Configuration& q) { return axis_obstacle(*device, q); });
  return device;
}

}  // namespace softfinger
