#include "softfinger/device/kinds/plate_2dof.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/device/tilt.hpp"
#include "softfinger/device/workspace.hpp"

namespace softfinger {
namespace {

DeviceSettings with_plate_axes(DeviceSettings settings, const Plate2dofGeometry& geometry) {
  settings.axes = Plate2dof::axes_for(geometry, settings.joint_limits);
  return settings;
}

}  // namespace

Plate2dof::Plate2dof(DeviceSettings settings, const Plate2dofGeometry& geometry)
    : RigidDisk(with_plate_axes(std::move(settings), geometry), geometry.disk_radius,
                geometry.disk_edge_radius),
      geometry_(geometry),
      names_{"joint_1", "joint_2", "joint_1", "joint_2", axes()[0].name, axes()[0].name} {}

std::vector<ConfigurationAxis> Plate2dof::axes_for(const Plate2dofGeometry& geometry,
                                                   const JointLimits& limits) {
  const double r = geometry.pinion_radius;
  return {{geometry.rolls ? "roll_deg" : "pitch_deg", deg, geometry.disk_radius, -geometry.max_tilt,
           geometry.max_tilt},
          {"travel_mm", mm, 1.0, r * limits.min.minCoeff(), r * limits.max.maxCoeff()}};
}

bool Plate2dof::inverse_kinematics(const Configuration& q, JointAngles& joints) const {
  joints.resize(2);
  for (int i = 0; i < 2; ++i) {
    joints[i] = (q[1] + side(i) * geometry_.lever * std::sin(q[0])) / geometry_.pinion_radius;
  }
  return true;
}

void Plate2dof::clamped_joints(const Configuration& q, JointAngles& joints) const {
  static_cast<void>(inverse_kinematics(q, joints));
  joints = joints.cwiseMax(joint_limits().min).cwiseMin(joint_limits().max);
}

bool Plate2dof::forward_kinematics(const JointAngles& joints, Configuration& q) const {
  if (joints.size() != 2 || !joints.allFinite()) return false;
  const double sine = 0.5 * geometry_.pinion_radius * (joints[0] - joints[1]) / geometry_.lever;
  if (std::abs(sine) > 1.0) return false;
  q.resize(2);
  q << std::asin(sine), 0.5 * geometry_.pinion_radius * (joints[0] + joints[1]);
  return reachable(q);
}

bool Plate2dof::reachable(const Configuration& q) const {
  constexpr double kTolerance = 1e-9;  // rad
  JointAngles joints;
  return within_axes(q) && inverse_kinematics(q, joints) &&
         (joints - joint_limits().max).maxCoeff() <= kTolerance &&
         (joint_limits().min - joints).maxCoeff() <= kTolerance;
}

bool Plate2dof::constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                            Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const double r = geometry_.pinion_radius;
  for (int i = 0; i < 2; ++i) {
    const double arm = side(i) * geometry_.lever;
    const double rack = q[1] + arm * std::sin(q[0]);
    values[i] = rack - r * joint_limits().max[i];
    values[2 + i] = r * joint_limits().min[i] - rack;
    jacobian.row(i) << arm * std::cos(q[0]), 1.0;
    jacobian.row(2 + i) = -jacobian.row(i);
    values[4 + i] = geometry_.disk_radius * (side(i) * q[0] - geometry_.max_tilt);
    jacobian.row(4 + i) << side(i) * geometry_.disk_radius, 0.0;
  }
  return true;
}

void Plate2dof::add_constraint_curvature(const Configuration& q,
                                         const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                         Eigen::Ref<Eigen::MatrixXd> hessian) const {
  for (int i = 0; i < 2; ++i) {
    const double pushed = std::max(0.0, multipliers[i]) - std::max(0.0, multipliers[2 + i]);
    hessian(0, 0) -= pushed * side(i) * geometry_.lever * std::sin(q[0]);
  }
}

std::span<const std::string> Plate2dof::constraint_names(int k) const {
  return {&names_[static_cast<std::size_t>(k)], 1};
}

Configuration Plate2dof::facing(const Vector3& normal_F, const Configuration& q) const {
  const Vector3 n = settings().X_FB.rotation.transpose() * normal_F;
  const double across = geometry_.rolls ? -n.y() : n.x();
  Configuration turned = q;
  // Straight away from the finger no direction is nearer than another: stay level.
  turned[0] = std::abs(across) > 1e-12
                  ? std::clamp(std::atan2(across, n.z()), -geometry_.max_tilt, geometry_.max_tilt)
                  : 0.0;
  return turned;
}

Pose Plate2dof::surface_pose(const Configuration& q) const {
  const Tilt tilt(geometry_.rolls ? 0.0 : q[0], geometry_.rolls ? q[0] : 0.0);
  return settings().X_FB * Pose{tilt.rotation(), Vector3(0.0, 0.0, q[1])};
}

RigidDisk::PoseRate Plate2dof::pose_rate(const Configuration& q, int k) const {
  if (k == 1) return {Matrix3::Zero(), Vector3::UnitZ()};
  const Tilt tilt(geometry_.rolls ? 0.0 : q[0], geometry_.rolls ? q[0] : 0.0);
  return {tilt.derivative(geometry_.rolls ? &PlaneFunction::r : &PlaneFunction::p),
          Vector3::Zero()};
}

PlatformSpace Plate2dof::space() const {
  // Directions in which the plate does not turn say nothing: the tilt is taken about its one axis.
  return {.reachable =
              [this](double pitch, double roll, double travel) {
                Configuration q(2);
                q << std::copysign(std::hypot(pitch, roll), pitch), travel;
                return reachable(q);
              },
          .low = axes()[1].min,
          .high = axes()[1].max,
          .home_travel = home()[1],
          .max_tilt = geometry_.max_tilt};
}

WorkspaceSummary Plate2dof::workspace_summary() const {
  return summarise_platform_workspace(space());
}

WorkspaceOutline Plate2dof::workspace_outline() const {
  WorkspaceOutline outline = outline_platform_workspace(space());
  (geometry_.rolls ? outline.roll_axis : outline.pitch_axis) = 0;
  outline.travel_axis = 1;
  return outline;
}

}  // namespace softfinger
