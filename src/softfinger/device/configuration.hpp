#pragma once

#include <Eigen/Core>

namespace softfinger {

inline constexpr int kMaxDegreesOfFreedom = 256;

/// Device configuration q in the device's own order; rad for angles, m for lengths. Storage is
/// inside the object, so that the real-time path never allocates.
using Configuration =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxDegreesOfFreedom, 1>;

/// Joint (motor) values in the device's order of joints; rad, or m for linear ones.
using JointAngles = Configuration;

}  // namespace softfinger
