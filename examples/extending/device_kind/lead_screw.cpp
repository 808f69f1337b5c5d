#include "lead_screw.hpp"

#include <numbers>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/surfaces/disk_surface.hpp"

namespace softfinger {

LeadScrew::LeadScrew(const DeviceSettings& settings, double lead)
    : Kinematics(settings), travel_per_rad_(lead / (2.0 * std::numbers::pi)) {}

bool LeadScrew::inverse_kinematics(const Configuration& q, JointAngles& joints) const {
  joints = q / travel_per_rad_;
  return true;
}

bool LeadScrew::forward_kinematics(const JointAngles& joints, Configuration& q) const {
  if (joints.size() != 1) return false;
  q = joints * travel_per_rad_;
  return reachable(q);
}

Pose LeadScrew::pose(const Configuration& q) const {
  return {Matrix3::Identity(), Vector3(0.0, 0.0, q[0])};
}

RigidMotion LeadScrew::motion(const Configuration& q) const {
  return {.X_BP = pose(q), .count = 1, .rate = {PoseRate{.translation = Vector3::UnitZ()}}};
}

namespace {

std::shared_ptr<const Device> read_lead_screw(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable geometry = file.root().table("geometry");
  const double lead = geometry.number("lead_mm", Range::positive());
  const double radius = geometry.number("disk_radius_mm", Range::positive());
  const double edge_radius = read_disk_edge_radius(geometry, radius);
  settings.joint_limits = read_joint_limits(file.root().table("limits"), 1);
  const double travel_per_rad = lead / (2.0 * std::numbers::pi);
  settings.axes = {ConfigurationAxis::length("travel_mm",
                                             travel_per_rad * settings.joint_limits.min[0],
                                             travel_per_rad * settings.joint_limits.max[0])};
  read_shared_tables(file, settings);
  auto kinematics = std::make_unique<const LeadScrew>(settings, lead);
  check_rest_poses(file, settings,
                   [&](const Configuration& q) { return axis_obstacle(*kinematics, q); });
  return std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                        std::make_unique<const DiskSurface>(radius, edge_radius));
}

}  // namespace

const DeviceKind& lead_screw_kind() {
  static const DeviceKind kKind{.name = "lead_screw",
                                .words = "disk on a lead screw",
                                .read = read_lead_screw,
                                .example = R"toml(
[mount]
translation_mm = [1.0, 0.0, -10.3]
[geometry]
lead_mm = 12.0
disk_radius_mm = 6.0
[limits]
joint_deg = [-120.0, 180.0]
joint_rate_deg_per_s = 600.0
[retract]
travel_mm = -3.0
)toml"};
  return kKind;
}

}  // namespace softfinger
