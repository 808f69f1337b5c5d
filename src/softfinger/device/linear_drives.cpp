#include "softfinger/device/linear_drives.hpp"

namespace softfinger {

LinearDrives::LinearDrives(DeviceSettings settings) : Device(std::move(settings)) {
  for (const ConfigurationAxis& axis : axes()) names_.push_back(axis.name);
}

void LinearDrives::set_joint_limits(DeviceSettings& settings, double max_rate) {
  const auto count = static_cast<Eigen::Index>(settings.axes.size());
  JointLimits& limits = settings.joint_limits;
  limits.linear = true;
  limits.max_rate = max_rate;
  limits.min.resize(count);
  limits.max.resize(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    limits.min[k] = settings.axes[static_cast<std::size_t>(k)].min;
    limits.max[k] = settings.axes[static_cast<std::size_t>(k)].max;
  }
}

bool LinearDrives::inverse_kinematics(const Configuration& q, JointAngles& joints) const {
  joints = q;
  return true;
}

void LinearDrives::clamped_joints(const Configuration& q, JointAngles& joints) const {
  joints = q.cwiseMax(joint_limits().min).cwiseMin(joint_limits().max);
}

bool LinearDrives::forward_kinematics(const JointAngles& joints, Configuration& q) const {
  q = joints;
  return within_axes(q);
}

bool LinearDrives::constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                               Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const int n = degrees_of_freedom();
  jacobian.setZero();
  for (int k = 0; k < n; ++k) {
    const ConfigurationAxis& axis = axes()[static_cast<std::size_t>(k)];
    values[k] = axis.metric * (q[k] - axis.max);
    values[n + k] = axis.metric * (axis.min - q[k]);
    jacobian(k, k) = axis.metric;
    jacobian(n + k, k) = -axis.metric;
  }
  return true;
}

void LinearDrives::add_constraint_curvature(
    const Configuration& /*q*/, const Eigen::Ref<const Eigen::VectorXd>& /*multipliers*/,
    Eigen::Ref<Eigen::MatrixXd> /*hessian*/) const {}  // straight limits do not curve

std::span<const std::string> LinearDrives::constraint_names(int k) const {
  return {&names_[static_cast<std::size_t>(k % degrees_of_freedom())], 1};
}

Configuration LinearDrives::facing(const Vector3& /*normal_F*/, const Configuration& q) const {
  return q;
}

WorkspaceSummary LinearDrives::workspace_summary() const {
  WorkspaceSummary summary;
  for (const ConfigurationAxis& axis : axes()) {
    summary.reaches.push_back({axis.name, axis.min, axis.max, axis.unit});
  }
  return summary;
}

}  // namespace softfinger
