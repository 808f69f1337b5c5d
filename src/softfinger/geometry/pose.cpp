#include "softfinger/geometry/pose.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {

void transform(const Pose& X_AB, std::span<const Vector3> points_B, std::span<Vector3> points_A) {
  for (std::size_t i = 0; i < points_B.size(); ++i) points_A[i] = X_AB * points_B[i];
}

Matrix3 skew(const Vector3& a) {
  Matrix3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

Vector3 vee(const Matrix3& m) { return {m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)}; }

Matrix3 exp_rotation(const Vector3& rotation_vector) {
  const double angle2 = rotation_vector.squaredNorm();
  const double angle = std::sqrt(angle2);
  // Taylor polynomials where sin(x)/x and (1-cos x)/x^2 would cancel.
  const double a = angle < 1e-4 ? 1.0 - angle2 / 6.0 : std::sin(angle) / angle;
  const double b = angle < 1e-4 ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
  const Matrix3 w = skew(rotation_vector);
  return Matrix3::Identity() + a * w + b * w * w;
}

Vector3 log_rotation(const Matrix3& rotation) {
  // By way of the quaternion: accurate for every angle, pi included.
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  const double angle = 2.0 * std::atan2(sine, q.w());
  const double factor = sine < 1e-8 ? 2.0 / q.w() : angle / sine;
  return factor * q.vec();
}

Pose interpolate(const Pose& from, const Pose& to, double fraction) {
  const Vector3 turn = log_rotation(from.rotation.transpose() * to.rotation);
  return {from.rotation * exp_rotation(fraction * turn),
          from.translation + fraction * (to.translation - from.translation)};
}

Pose moved_towards(const Pose& from, const Pose& to, double distance, double angle) {
  Pose result = to;
  const Vector3 shift = to.translation - from.translation;
  const double length = shift.norm();
  if (length > distance) result.translation = from.translation + shift * (distance / length);
  const Vector3 turn = log_rotation(from.rotation.transpose() * to.rotation);
  const double turned = turn.norm();
  if (turned > angle) result.rotation = from.rotation * exp_rotation(turn * (angle / turned));
  return result;
}

Matrix3 orthonormalised(const Matrix3& rotation) {
  return Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
}

}  // namespace softfinger
