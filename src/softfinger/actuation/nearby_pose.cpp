#include "softfinger/actuation/nearby_pose.hpp"

#include <Eigen/LU>

namespace softfinger {
namespace {

/// Of a configuration, rad or m.
constexpr double kDifference = 1e-6;
constexpr int kNewtonSteps = 2;

}  // namespace

bool nearby_pose(const Device& device, const JointAngles& joints, const Configuration& near,
                 Configuration& q) {
  using Derivative =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostServos, kMostServos>;
  const Eigen::Index n = near.size();
  if (joints.size() != n) return device.forward_kinematics(joints, q);
  Derivative derivative(n, n);
  JointAngles above;
  JointAngles below;
  for (Eigen::Index i = 0; i < n; ++i) {
    q = near;
    q[i] = near[i] + kDifference;
    if (!device.inverse_kinematics(q, above)) return false;
    q[i] = near[i] - kDifference;
    if (!device.inverse_kinematics(q, below)) return false;
    derivative.col(i) = (above - below) / (2.0 * kDifference);
  }
  const Eigen::PartialPivLU<Derivative> inverse(derivative);
  const auto step_closer = [&] {
    JointAngles now;
    if (!device.inverse_kinematics(q, now)) return false;
    q += inverse.solve(joints - now);
    return true;
  };
  q = near;
  for (int step = 0; step < kNewtonSteps; ++step) {
    if (!step_closer()) return false;
  }
  return q.allFinite();
}

}  // namespace softfinger
