#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/kinds/membrane.hpp"

namespace softfinger {

std::shared_ptr<const Device> read_membrane(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable sizes = file.root().table("geometry");
  MembraneGeometry geometry;
  geometry.ring_radius = sizes.number("ring_radius_mm", Range::positive());
  geometry.rim_width = sizes.number("rim_width_mm", Range::at_least(0.0), 1.0 * mm);
  geometry.rim_edge_radius = sizes.number("rim_edge_radius_mm", Range::between(0.0, 1.0), 0.5 * mm);
  const ConfigTable limits = file.root().table("limits");
  const Interval height = read_interval(limits, "height_mm", Range::at_least(0.0));
  geometry.min_height = height.min;
  geometry.max_height = height.max;
  if (geometry.max_height > geometry.ring_radius) {
    limits.fail("height_mm", "must be at most ring_radius_mm: a cap is no more than half a ball");
  }
  if (geometry.rim_edge_radius > geometry.ring_radius + geometry.rim_width) {
    sizes.fail("rim_edge_radius_mm", "must be at most the ring's outside radius");
  }

  settings.axes = Membrane::axes_for(geometry);
  LinearDrives::set_joint_limits(settings, read_linear_rate(limits));
  read_shared_tables(file, settings);
  auto device = std::make_shared<const Membrane>(std::move(settings), geometry);
  check_rest_poses(file, *device,
                   [&](const Configuration& q) { return axis_obstacle(*device, q); });
  return device;
}

}  // namespace softfinger
