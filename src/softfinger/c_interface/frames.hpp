#pragma once

#include <optional>

#include "softfinger/geometry/pose.hpp"
#include "softfinger/softfinger.h"

namespace softfinger {

/// Norms of quaternions, and rows of rotation matrices, are 1 up to this.
inline constexpr double kRotationTolerance = 1e-3;

/// Of a pose whose size is right; empty where it is not finite or no rotation.
[[nodiscard]] std::optional<Pose> pose_of(const sf_pose& pose);
/// Of a 4 x 4 matrix, row by row; a rotation is taken as it is, to the bit.
[[nodiscard]] std::optional<Pose> pose_of(const double (&matrix)[16]);
[[nodiscard]] sf_pose c_pose(const Pose& pose);

}  // namespace softfinger
