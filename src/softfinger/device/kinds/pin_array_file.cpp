#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/kinds/pin_array.hpp"

namespace softfinger {

std::shared_ptr<const Device> read_pin_array(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable sizes = file.root().table("geometry");
  PinArrayGeometry geometry;
  geometry.rows = sizes.integer("rows", 1, kMaxPinRows);
  geometry.columns = sizes.integer("columns", 1, kMaxPinRows);
  geometry.pitch = sizes.number("pitch_mm", Range::positive());
  geometry.pin_radius = sizes.number("pin_radius_mm", Range::positive());
  geometry.stroke = sizes.number("stroke_mm", Range::positive());
  geometry.pin_edge_radius =
      sizes.number("pin_edge_radius_mm", Range::at_least(0.0), 0.2 * geometry.pin_radius);
  if (2.0 * geometry.pin_radius > geometry.pitch) {
    sizes.fail("pin_radius_mm", "must be at most half of pitch_mm: pins cannot overlap");
  }
  if (geometry.pin_edge_radius > geometry.pin_radius) {
    sizes.fail("pin_edge_radius_mm", "must be at most pin_radius_mm");
  }

  settings.axes = PinDrives::axes_for(geometry);
  LinearDrives::set_joint_limits(settings, read_linear_rate(file.root().table_or_empty("limits")));
  read_shared_tables(file, settings);
  auto device = make_pin_array(std::move(settings), geometry);
  check_rest_poses(file, device->settings(),
                   [&](const Configuration& q) { return axis_obstacle(device->kinematics(), q); });
  return device;
}

}  // namespace softfinger
