#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/delta_tactor.hpp"
#include "softfinger/device/kinds/device_readers.hpp"

namespace softfinger {

std::shared_ptr<const Device> read_delta_tactor(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable lengths = file.root().table("geometry");
  DeltaTactorGeometry geometry;
  geometry.base_radius = lengths.number("base_radius_mm", Range::positive());
  geometry.platform_radius = lengths.number("platform_radius_mm", Range::positive());
  geometry.crank = lengths.number("crank_mm", Range::positive());
  geometry.forearm = lengths.number("forearm_mm", Range::positive());
  geometry.neutral_height = lengths.number("neutral_height_mm", Range::positive());
  geometry.tip_radius = lengths.number("tip_radius_mm", Range::positive());
  settings.joint_limits = read_joint_limits(file.root().table("limits"), 3);

  settings.axes = DeltaTactor::axes_for(geometry);
  read_shared_tables(file, settings);
  auto device = std::make_shared<const DeltaTactor>(std::move(settings), geometry);
  check_rest_poses(file, *device, [&](const Configuration& q) -> std::string {
    JointAngles joints;
    if (!device->inverse_kinematics(q, joints)) {
      return "the legs do not reach: no inverse kinematics (check crank_mm, forearm_mm, "
             "neutral_height_mm and the radii)";
    }
    std::string joint = joint_obstacle(*device, q);
    if (!joint.empty()) return joint;
    return device->reachable(q) ? "" : "the legs are singular there, or on the way from home";
  });
  return device;
}

}  // namespace softfinger
