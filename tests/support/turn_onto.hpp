#pragma once

#include <cmath>
#include <numbers>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Rotation matrix of a shortest turn that takes the unit vector `from` to the unit vector `to`.
/// Eigen's Quaternion::FromTwoVectors has every file that calls it compile a decomposition.
inline Matrix3 turn_onto(const Vector3& from, const Vector3& to) {
  const Vector3 axis = from.cross(to);
  const double sine = axis.norm();
  if (sine > 1e-12) return exp_rotation(std::atan2(sine, from.dot(to)) / sine * axis);
  if (from.dot(to) > 0.0) return Matrix3::Identity();
  return exp_rotation(std::numbers::pi * from.unitOrthogonal());
}

}  // namespace softfinger
