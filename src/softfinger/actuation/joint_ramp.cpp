#include "softfinger/actuation/joint_ramp.hpp"

#include <algorithm>
#include <utility>

namespace softfinger {

JointRamp::JointRamp(std::shared_ptr<const Device> device, std::span<const ServoMap> servos)
    : device_(std::move(device)), servos_(servos) {
  device_->clamped_joints(device_->retracted(), goal_);
  joints_ = goal_;
}

void JointRamp::start(const JointAngles& standing) {
  const JointLimits& limits = device_->joint_limits();
  joints_ = standing;
  least_ = limits.min.cwiseMin(standing);
  largest_ = limits.max.cwiseMax(standing);
  rate_ = 0.0;
  under_way_ = true;
  form();
}

void JointRamp::step(double dt) {
  const JointLimits& limits = device_->joint_limits();
  rate_ = std::min(limits.max_rate, rate_ + limits.max_acceleration * dt);
  const double travel = rate_ * dt;
  for (Eigen::Index i = 0; i < joints_.size(); ++i) {
    joints_[i] = std::clamp(goal_[i], joints_[i] - travel, joints_[i] + travel);
  }
  form();
}

void JointRamp::form() {
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    targets_[i] = servos_[i].target(joints_[joint], least_[joint], largest_[joint]);
  }
}

}  // namespace softfinger
