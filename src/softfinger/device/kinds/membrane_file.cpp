#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/linear_drives.hpp"
#include "softfinger/device/surfaces/cap_surface.hpp"

namespace softfinger {

// After the softness displays with a membrane under the pad, e.g. Frediani, Carpi, "Tactile display
// of softness on fingertip", Scientific Reports 10, 2020.
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

  settings.axes = {
      ConfigurationAxis::length("height_mm", geometry.min_height, geometry.max_height)};
  LinearDrives::set_joint_limits(settings, read_linear_rate(limits));
  read_shared_tables(file, settings);
  // Height shapes the surface; nothing carries it along.
  auto kinematics =
      std::make_unique<const LinearDrives>(settings, std::vector<Vector3>{Vector3::Zero()}, 0);
  check_rest_poses(file, settings,
                   [&](const Configuration& q) { return axis_obstacle(*kinematics, q); });
  return std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                        std::make_unique<const CapSurface>(geometry));
}

}  // namespace softfinger
