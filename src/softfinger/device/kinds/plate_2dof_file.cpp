#include <fmt/core.h>

#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/kinds/plate_2dof.hpp"
#include "softfinger/device/surfaces/disk_surface.hpp"

namespace softfinger {

std::shared_ptr<const Device> read_plate_2dof(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable lengths = file.root().table("geometry");
  Plate2dofGeometry geometry;
  geometry.rolls = lengths.choice("turns", {"pitch", "roll"}, "pitch") == "roll";
  geometry.lever = lengths.number("lever_mm", Range::positive());
  geometry.pinion_radius = lengths.number("pinion_radius_mm", Range::positive());
  geometry.disk_radius = lengths.number("disk_radius_mm", Range::positive());
  geometry.disk_edge_radius = read_disk_edge_radius(lengths, geometry.disk_radius);
  const ConfigTable limits = file.root().table("limits");
  settings.joint_limits = read_joint_limits(limits, 2);
  geometry.max_tilt = read_max_tilt(limits);

  settings.axes = Plate2dof::axes_for(geometry, settings.joint_limits);
  read_shared_tables(file, settings);
  auto kinematics = std::make_unique<const Plate2dof>(settings, geometry);
  check_rest_poses(file, settings, [&](const Configuration& q) -> std::string {
    if (std::abs(q[0]) > geometry.max_tilt + 1e-9) {
      return fmt::format("tilt of {:.4g} degrees is more than limits.max_tilt_deg {:g}", q[0] / deg,
                         geometry.max_tilt / deg);
    }
    return joint_obstacle(*kinematics, q);
  });
  return std::make_shared<const Device>(
      std::move(settings), std::move(kinematics),
      std::make_unique<const DiskSurface>(geometry.disk_radius, geometry.disk_edge_radius));
}

}  // namespace softfinger
