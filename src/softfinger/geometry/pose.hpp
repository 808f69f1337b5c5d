#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

namespace softfinger {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// Rigid transform X_AB: coordinates in B to coordinates in A, p_A = rotation * p_B + translation.
/// Translation in metres.
struct Pose {
  Matrix3 rotation = Matrix3::Identity();
  Vector3 translation = Vector3::Zero();

  [[nodiscard]] Vector3 operator*(const Vector3& p_B) const { return rotation * p_B + translation; }
  [[nodiscard]] Pose operator*(const Pose& X_BC) const {
    return {rotation * X_BC.rotation, rotation * X_BC.translation + translation};
  }
  [[nodiscard]] Pose inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation)};
  }
};

/// Every point in B to A; spans of one length.
void transform(const Pose& X_AB, std::span<const Vector3> points_B, std::span<Vector3> points_A);

/// Cross-product matrix: skew(a) * b = a x b.
[[nodiscard]] Matrix3 skew(const Vector3& a);
/// Twice the vector of a matrix's antisymmetric part: vee(skew(a)) = 2 a.
[[nodiscard]] Vector3 vee(const Matrix3& m);
/// Rotation matrix of a rotation vector (axis times angle in radians).
[[nodiscard]] Matrix3 exp_rotation(const Vector3& rotation_vector);
/// Rotation vector of a rotation matrix, angle in [0, pi].
[[nodiscard]] Vector3 log_rotation(const Matrix3& rotation);
/// On the way from `from` to `to`, the straight line and the shortest turn: `from` at fraction 0,
/// `to` at 1, both up to rounding.
[[nodiscard]] Pose interpolate(const Pose& from, const Pose& to, double fraction);
/// `from` moved towards `to` by at most `distance` (m) and `angle` (rad); `to` itself, to the bit,
/// where it is that near.
[[nodiscard]] Pose moved_towards(const Pose& from, const Pose& to, double distance, double angle);
/// Nearest rotation to a matrix that is one up to rounding.
[[nodiscard]] Matrix3 orthonormalised(const Matrix3& rotation);

}  // namespace softfinger
