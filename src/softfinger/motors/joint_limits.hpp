#pragma once

#include <Eigen/Core>
#include <limits>

namespace softfinger {

inline constexpr int kMostJoints = 256;

/// Joint (motor) values in the device's order of joints; rad, or m for linear ones. Storage is
/// inside the object, so that the real-time path never allocates.
using JointAngles = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostJoints, 1>;

/// Hard limits of the joints; commands never leave them.
struct JointLimits {
  JointAngles min, max;   ///< rad, or m for linear joints
  double max_rate = 0.0;  ///< rad/s or m/s, all joints
  /// How fast a joint may get faster, rad/s^2 or m/s^2; it may always stop at once.
  double max_acceleration = std::numeric_limits<double>::infinity();
  bool linear = false;  ///< joints are lengths
};

}  // namespace softfinger
