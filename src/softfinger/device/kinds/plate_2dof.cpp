#include "softfinger/device/kinds/plate_2dof.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/device/tilt.hpp"
#include "softfinger/device/workspace.hpp"

namespace softfinger {

Plate2dof::Plate2dof(const DeviceSettings& settings, const Plate2dofGeometry& geometry)
    : Kinematics(settings),
      geometry_(geometry),
      names_{"joint_1", "joint_2", "joint_1", "joint_2", axes()[0].name, axes()[0].name} {}

std::vector<ConfigurationAxis> Plate2dof::axes_for(const Plate2dofGeometry& geometry,
                                                   const JointLimits& limits) {
  const double r = geometry.pinion_radius;
  return {
      ConfigurationAxis::angle(geometry.rolls ? "roll_deg" : "pitch_deg", geometry.disk_radius,
                               -geometry.max_tilt, geometry.max_tilt),
      ConfigurationAxis::length("travel_mm", r * limits.min.minCoeff(), r * limits.max.maxCoeff())};
}

bool Plate2dof::inverse_kinematics(const Configuration& q, JointAngles& joints) const {
  joints.resize(2);
  for (int i = 0; i < 2; ++i) {
    joints[i] = (q[1] + side(i) * geometry_.lever * std::sin(q[0])) / geometry_.pinion_radius;
  }
  return true;
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
  const Vector3 n = mount().rotation.transpose() * normal_F;
  const double across = geometry_.rolls ? -n.y() : n.x();
  Configuration turned = q;
  // Straight away from the finger no direction is nearer than another: stay level.
  turned[0] = std::abs(across) > 1e-12
                  ? std::clamp(std::atan2(across, n.z()), -geometry_.max_tilt, geometry_.max_tilt)
                  : 0.0;
  return turned;
}

Pose Plate2dof::pose(const Configuration& q) const {
  return {tilt(q).rotation(), Vector3(0.0, 0.0, q[1])};
}

RigidMotion Plate2dof::motion(const Configuration& q) const {
  const Tilt here = tilt(q);
  return {.X_BP = {here.rotation(), Vector3(0.0, 0.0, q[1])},
          .count = 2,
          .rate = {PoseRate{.rotation = here.derivative(geometry_.rolls ? &PlaneFunction::r
                                                                        : &PlaneFunction::p)},
                   PoseRate{.translation = Vector3::UnitZ()}}};
}

Tilt Plate2dof::tilt(const Configuration& q) const {
  return {geometry_.rolls ? 0.0 : q[0], geometry_.rolls ? q[0] : 0.0};
}

std::optional<PlatformSpace> Plate2dof::platform_space() const {
  return space_of(
      {.pitch = geometry_.rolls ? -1 : 0, .roll = geometry_.rolls ? 0 : -1, .travel = 1},
      axes()[1].min, axes()[1].max, geometry_.max_tilt);
}

}  // namespace softfinger
