#include "softfinger/twin/yielding_twin.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/twin/motor_torque.hpp"

namespace softfinger {
namespace {

constexpr int kBalanceSteps = 40;
constexpr int kTries = 10;                 // of lengths of a step
constexpr double kOvershoot = 0.3;         // of the slope at its start
constexpr double kUndershoot = 0.7;        // likewise
constexpr double kImbalance = 1e-4;        // N, and of the skin's load
constexpr double kLongestStep = 0.5 * mm;  // of surface motion
constexpr double kDifference = 0.01 * mm;  // likewise, between two looks at the joints
constexpr double kLeastStiffness = 1e-3;   // N by m: where neither skin nor motors say anything

}  // namespace

YieldingTwin::YieldingTwin(std::shared_ptr<const FingerModel> wearer,
                           std::shared_ptr<const Device> device)
    : twin_(std::move(wearer), std::move(device)),
      yielded_(Configuration::Zero(twin_.device().degrees_of_freedom())) {}

double YieldingTwin::size(const Eigen::VectorXd& load) const {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < load.size(); ++k) {
    const double metric = twin_.device().axes()[static_cast<std::size_t>(k)].metric;
    sum += load[k] * load[k] / (metric * metric);
  }
  return std::sqrt(sum);
}

Eigen::MatrixXd YieldingTwin::joints_by_q(const Configuration& q, const JointAngles& joints) const {
  const Device& device = twin_.device();
  Eigen::MatrixXd by_q = Eigen::MatrixXd::Zero(joints.size(), q.size());
  JointAngles ahead;
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const double h = kDifference / device.axes()[static_cast<std::size_t>(k)].metric;
    for (const double way : {h, -h}) {
      Configuration moved = q;
      moved[k] += way;
      if (!device.inverse_kinematics(moved, ahead)) continue;
      // Where it closes on one side alone that side counts twice.
      const bool both = !by_q.col(k).isZero(0.0);
      const Eigen::VectorXd slope = (ahead - joints) / way;
      by_q.col(k) = both ? Eigen::VectorXd(0.5 * (by_q.col(k) + slope)) : slope;
    }
  }
  return by_q;
}

YieldingTwin::Balance YieldingTwin::balance(const JointAngles& sent) {
  const Device& device = twin_.device();
  Balance at;
  DeviceLoad skin;
  static_cast<void>(twin_.load_and_derivative(skin));  // what there is of it
  JointAngles joints;
  if (!device.inverse_kinematics(twin_.configuration(), joints)) joints = sent;
  const Eigen::MatrixXd by_q = joints_by_q(twin_.configuration(), joints);
  Eigen::VectorXd torques(joints.size());
  Eigen::VectorXd rates(joints.size());
  for (Eigen::Index j = 0; j < joints.size(); ++j) {
    const MotorTorque motor =
        motor_torque(*device.settings().statics, device.joint_limits().linear, joints[j] - sent[j]);
    torques[j] = motor.torque;
    rates[j] = motor.rate;
    at.torque = std::max(at.torque, std::abs(motor.torque));
    at.gives_way = at.gives_way || motor.gives_way;
  }
  at.rest = by_q.transpose() * torques - skin.load;
  at.stiffness = by_q.transpose() * rates.asDiagonal() * by_q - skin.by_q;
  at.size = size(at.rest);
  at.load = size(skin.load);
  return at;
}

Configuration YieldingTwin::step(const Balance& at) const {
  const Device& device = twin_.device();
  Eigen::MatrixXd stiffness = at.stiffness;
  for (Eigen::Index k = 0; k < stiffness.rows(); ++k) {
    const double metric = device.axes()[static_cast<std::size_t>(k)].metric;
    stiffness(k, k) += kLeastStiffness * metric * metric;
  }
  Configuration step = -stiffness.fullPivLu().solve(at.rest);
  if (!(at.rest.dot(step) < 0.0)) {  // downhill, whatever the derivative says
    for (Eigen::Index k = 0; k < step.size(); ++k) {
      const double metric = device.axes()[static_cast<std::size_t>(k)].metric;
      step[k] = -at.rest[k] / (metric * metric);
    }
  }
  const Configuration none = Configuration::Zero(step.size());
  const double length = std::sqrt(device.squared_distance(step, none));
  if (length > kLongestStep) step *= kLongestStep / length;
  return step;
}

// Play and what a motor holds have corners, where Newton's step overshoots: the energy's slope
// along the step, not its own size, says whether it did.
YieldingTwin::Balance YieldingTwin::search(const Configuration& step, const Balance& at,
                                           const JointAngles& sent, TwinSummary& summary) {
  const Device& device = twin_.device();
  const Configuration from = twin_.configuration();
  const double slope = -at.rest.dot(step);
  double low = 0.0;
  double low_slope = slope;
  double high = 1.0;
  double part = 1.0;
  Balance next = at;
  JointAngles joints;
  for (int k = 0; k < kTries; ++k) {
    const Configuration there = from + part * step;
    if (!device.inverse_kinematics(there, joints)) {
      high = part;
      part = 0.5 * (low + high);
      continue;
    }
    const TwinSummary tried = twin_.attempt(there);
    summary.iterations += tried.iterations;
    summary.converged = tried.converged;
    next = balance(sent);
    const double beyond = next.rest.dot(step);
    if (beyond <= kOvershoot * slope && (beyond >= -kUndershoot * slope || part == 1.0)) break;
    if (beyond > 0.0) {
      high = part;
      part = low + (high - low) * std::clamp(low_slope / (low_slope + beyond), 0.05, 0.95);
    } else {
      low = part;
      low_slope = -beyond;
      part = 0.5 * (low + high);
    }
  }
  return next;
}

YieldingSummary YieldingTwin::press(const Configuration& q, double friction_coefficient,
                                    double elapsed) {
  const Device& device = twin_.device();
  JointAngles sent;
  JointAngles joints;
  YieldingSummary summary;
  if (!device.inverse_kinematics(q, sent)) {
    summary.balanced = false;
    summary.twin = twin_.press(q, friction_coefficient, elapsed);
    return summary;
  }
  const Configuration guess = q + yielded_;
  const bool closes = device.inverse_kinematics(guess, joints);
  summary.twin = twin_.press(closes ? guess : q, friction_coefficient, elapsed);
  twin_.begin_frame(friction_coefficient, 0.0);
  Balance at = balance(sent);
  for (int i = 0; i < kBalanceSteps && at.size > kImbalance * (1.0 + at.load); ++i) {
    at = search(step(at), at, sent, summary.twin);
  }
  const Configuration there = twin_.configuration();
  twin_.end_frame(there);
  yielded_ = there - q;
  summary.balanced = at.size <= kImbalance * (1.0 + at.load);
  summary.torque = at.torque;
  summary.gives_way = at.gives_way;
  return summary;
}

}  // namespace softfinger
