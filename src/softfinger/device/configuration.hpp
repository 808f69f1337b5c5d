#pragma once

#include "softfinger/motors/joint_limits.hpp"

namespace softfinger {

inline constexpr int kMaxDegreesOfFreedom = kMostJoints;

/// Device configuration q in the device's own order; rad for angles, m for lengths. Storage is
/// inside the object, so that the real-time path never allocates.
using Configuration =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxDegreesOfFreedom, 1>;

}  // namespace softfinger
