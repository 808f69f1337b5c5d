#include "softfinger/world/body_pull.hpp"

#include <cmath>

namespace softfinger {
namespace {

/// Of a spring that pulls no harder than its limit, at this length.
struct Pull {
  double energy = 0.0, force = 0.0;
  double along = 0.0, across = 0.0;  ///< stiffness by and across its direction
};
Pull pull_of(double length, double stiffness, double limit) {
  if (stiffness * length <= limit) {
    const double force = stiffness * length;
    return {0.5 * force * length, force, stiffness, stiffness};
  }
  return {limit * (length - 0.5 * limit / stiffness), limit, 0.0, limit / length};
}

}  // namespace

void BodyPull::begin(double h, const Pose& X_WO) {
  const double damping = following_.damping / h;
  const double turn_damping = following_.rotation_damping / h;
  stiffness_ = following_.stiffness + damping;
  rotation_stiffness_ = following_.rotation_stiffness + turn_damping;
  // Where dampers alone would leave it: it goes the way that tracking goes.
  const Vector3 carried = X_WO.translation + X_WT_.translation - X_WT_old_.translation;
  centre_.translation = X_WT_.translation + damping / stiffness_ * (carried - X_WT_.translation);
  const Matrix3 behind =
      X_WT_.rotation * X_WT_old_.rotation.transpose() * X_WO.rotation * X_WT_.rotation.transpose();
  const Vector3 turn = turn_damping / rotation_stiffness_ * log_rotation(behind);
  centre_.rotation = exp_rotation(turn) * X_WT_.rotation;
}

BodyPull::Value BodyPull::evaluate(const Pose& X_WO) const {
  Value value;
  const Vector3 way = X_WO.translation - centre_.translation;
  const double length = way.norm();
  const Pull pull = pull_of(length, stiffness_, following_.force_limit);
  value.energy += pull.energy;
  if (length > 0.0) value.by_origin = pull.force / length * way;
  const Vector3 turn = log_rotation(X_WO.rotation * centre_.rotation.transpose());
  const double angle = turn.norm();
  const Pull twist = pull_of(angle, rotation_stiffness_, following_.torque_limit);
  value.energy += twist.energy;
  if (angle > 0.0) value.by_turn = twist.force / angle * turn;
  return value;
}

Matrix6 BodyPull::hessian(const Pose& X_WO) const {
  const auto about = [](const Vector3& direction, double along, double across) {
    const double length = direction.norm();
    Matrix3 block = across * Matrix3::Identity();
    if (length > 0.0) {
      block += (along - across) / (length * length) * direction * direction.transpose();
    }
    return block;
  };
  Matrix6 h = Matrix6::Zero();
  const Vector3 way = X_WO.translation - centre_.translation;
  const Pull pull = pull_of(way.norm(), stiffness_, following_.force_limit);
  h.topLeftCorner<3, 3>() = about(way, pull.along, pull.across);
  const Vector3 turn = log_rotation(X_WO.rotation * centre_.rotation.transpose());
  const double angle = turn.norm();
  const Pull twist = pull_of(angle, rotation_stiffness_, following_.torque_limit);
  // Of the angle of exp(w) R across its axis: cot(angle / 2) / 2.
  double across = twist.across;
  if (angle > 1e-6) across = twist.force * 0.5 / std::tan(0.5 * angle);
  h.bottomRightCorner<3, 3>() = about(turn, twist.along, across);
  return h;
}

}  // namespace softfinger
