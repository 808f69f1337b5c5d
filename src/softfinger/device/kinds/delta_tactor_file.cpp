#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/delta_tactor.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/surfaces/ball_surface.hpp"

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
  auto kinematics = std::make_unique<const DeltaTactor>(settings, geometry);
  check_rest_poses(file, settings, [&](const Configuration& q) -> std::string {
    JointAngles joints;
    if (!kinematics->inverse_kinematics(q, joints)) {
      return "the legs do not reach: no inverse kinematics (check crank_mm, forearm_mm, "
             "neutral_height_mm and the radii)";
    }
    std::string joint = joint_obstacle(*kinematics, q);
    if (!joint.empty()) return joint;
    return kinematics->reachable(q) ? "" : "the legs are singular there, or on the way from home";
  });
  return std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                        std::make_unique<const BallSurface>(geometry.tip_radius));
}

}  // namespace softfinger
