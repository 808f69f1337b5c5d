#include "softfinger/device/linear_drives.hpp"

#include <utility>

namespace softfinger {

LinearDrives::LinearDrives(const DeviceSettings& settings, std::vector<Vector3> directions,
                           int approach_axis)
    : Kinematics(settings), directions_(std::move(directions)), approach_axis_(approach_axis) {
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

std::span<const std::string> LinearDrives::constraint_names(int k) const {
  return {&names_[static_cast<std::size_t>(k % degrees_of_freedom())], 1};
}

Pose LinearDrives::pose(const Configuration& q) const {
  Pose X_BP;
  for (std::size_t k = 0; k < directions_.size(); ++k) {
    X_BP.translation += q[static_cast<Eigen::Index>(k)] * directions_[k];
  }
  return X_BP;
}

RigidMotion LinearDrives::motion(const Configuration& q) const {
  RigidMotion motion{.X_BP = pose(q), .count = static_cast<int>(directions_.size()), .exact = true};
  for (std::size_t k = 0; k < directions_.size(); ++k) {
    motion.rate[k].translation = directions_[k];
  }
  return motion;
}

}  // namespace softfinger
