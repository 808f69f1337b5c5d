#pragma once

#include <optional>

#include "softfinger/geometry/pose.hpp"
#include "softfinger/softfinger.h"

namespace softfinger {

/// Norms of quaternions, and rows of rotation matrices, are 1 up to this.
inline constexpr double kRotationTolerance = 1e-3;

/// No finger is farther from the world's origin, in any direction, m.
inline constexpr double kFarthest = 1000.0;

/// Of a pose whose size is right; empty where it is too far, not finite or no rotation.
[[nodiscard]] std::optional<Pose> pose_of(const sf_pose& pose);
/// Of a 4 x 4 matrix, row by row; a rotation is taken as it is, to the bit.
[[nodiscard]] std::optional<Pose> pose_of(const double (&matrix)[16]);
[[nodiscard]] sf_pose c_pose(const Pose& pose);

}  // namespace softfinger
