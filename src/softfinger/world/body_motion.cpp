#include "softfinger/world/body_motion.hpp"

namespace softfinger {
namespace {

template <typename Value>
Value second_order(const Value& now, const Value& old, const Value& rate, const Value& old_rate,
                   double h) {
  return (4.0 * now - old) / 3.0 + 2.0 * h / 9.0 * (4.0 * rate - old_rate);
}

template <typename Value>
Value second_order_rate(const Value& next, const Value& now, const Value& old, double h) {
  return (3.0 * next - 4.0 * now + old) / (2.0 * h);
}

}  // namespace

BodyMotion::BodyMotion(const Body& body, const BodyPlace& start, const Vector3& velocity_W,
                       const Vector3& angular_velocity_W, double rate)
    : body_(body),
      now_(start),
      predicted_(start),
      centre_(centre_of(start.X_WO)),
      old_centre_(centre_),
      velocity_(velocity_W),
      old_velocity_(velocity_W),
      rotation_(start.X_WO.rotation),
      old_rotation_(rotation_),
      rotation_rate_(skew(angular_velocity_W) * rotation_),
      old_rotation_rate_(rotation_rate_),
      momentum_(inertia(rotation_) * angular_velocity_W),
      rate_(rate),
      old_rate_(rate),
      reference_centre_(centre_),
      reference_rotation_(rotation_) {}

void BodyMotion::rest_at(const Pose& X_WO) {
  now_.X_WO = X_WO;
  predicted_ = now_;
  reference_centre_ = centre_ = old_centre_ = centre_of(X_WO);
  reference_rotation_ = rotation_ = old_rotation_ = X_WO.rotation;
  velocity_ = old_velocity_ = momentum_ = Vector3::Zero();
  rotation_rate_ = old_rotation_rate_ = Matrix3::Zero();
  steps_ = 0;
}

void BodyMotion::rest() {
  rest_at(Pose(now_.X_WO));
  rate_ = old_rate_ = 0.0;
  old_q_ = now_.q;
}

Matrix3 BodyMotion::inertia_about_centre(const Matrix3& R_WO) const {
  const Matrix3 second = R_WO * body_.inertia.second_O * R_WO.transpose();
  return second.trace() * Matrix3::Identity() - second;
}

Matrix3 BodyMotion::inertia(const Matrix3& R_WO) const {
  Matrix3 sum = inertia_about_centre(R_WO);
  if (!turns_on_ball()) return sum;
  const Matrix3 way = skew(arm(R_WO));
  return sum - body_.inertia.mass * way * way;
}

Vector3 BodyMotion::angular_velocity() const {
  if (!body_.joint || turns_on_ball()) return inertia(rotation_).ldlt().solve(momentum_);
  const Matrix3 rate = rotation_rate_ * rotation_.transpose();
  return 0.5 * vee(rate);
}

Vector3 BodyMotion::mean_spin() const {
  const Matrix3 half = exp_rotation(Vector3(0.5 * time_step_ * angular_velocity())) * rotation_;
  return inertia(half).ldlt().solve(momentum_);
}

void BodyMotion::begin(double h, bool smooth) {
  time_step_ = h;
  second_order_ = smooth && steps_ > 0;
  weight_ = (second_order_ ? 2.25 : 1.0) / (h * h);
  turn_weight_ = body_.joint ? weight_ : 1.0 / (h * h);
  predicted_ = now_;
  if (by_joint()) {
    if (body_.freedoms == 1) {
      predicted_.q =
          second_order_ ? second_order(now_.q, old_q_, rate_, old_rate_, h) : now_.q + h * rate_;
    } else if (body_.joint->kind == JointKind::kBall) {
      weight_ = turn_weight_ = 1.0 / (h * h);
      const Vector3 turn_O = rotation_.transpose() * (h * mean_spin());
      predicted_.turn = now_.turn * exp_rotation(turn_O);
    }
    return;  // refer_to() follows
  }
  reference_centre_ = second_order_
                          ? second_order(centre_, old_centre_, velocity_, old_velocity_, h)
                          : Vector3(centre_ + h * velocity_);
  if (body_.joint) {
    reference_rotation_ = second_order_ ? second_order(rotation_, old_rotation_, rotation_rate_,
                                                       old_rotation_rate_, h)
                                        : Matrix3(rotation_ + h * rotation_rate_);
    if (body_.freedoms == 1) predicted_.q = now_.q + h * rate_;
    return;
  }
  reference_rotation_ = exp_rotation(Vector3(h * mean_spin())) * rotation_;
  predicted_.X_WO.rotation = reference_rotation_;
  predicted_.X_WO.translation = reference_centre_ - reference_rotation_ * body_.inertia.centre_O;
}

void BodyMotion::refer_to(const Pose& X_WO_predicted) {
  if (!by_joint()) return;
  reference_centre_ = centre_of(X_WO_predicted);
  reference_rotation_ = X_WO_predicted.rotation;
}

BodyMotion::Value BodyMotion::evaluate(const Pose& X_WO) const {
  Value value;
  const Vector3 dc = centre_of(X_WO) - reference_centre_;
  const Matrix3 dR = X_WO.rotation - reference_rotation_;
  value.by_centre = weight_ * body_.inertia.mass * dc;
  const Matrix3 by_R = turn_weight_ * dR * body_.inertia.second_O;
  value.by_turn = vee(by_R * X_WO.rotation.transpose());
  value.energy = 0.5 * (dc.dot(value.by_centre) + by_R.cwiseProduct(dR).sum());
  return value;
}

Matrix6 BodyMotion::hessian(const Pose& X_WO) const {
  // About the centre of mass, then as O's origin sees it.
  const Matrix3 way = skew(X_WO.rotation * body_.inertia.centre_O);
  const double m = weight_ * body_.inertia.mass;
  Matrix6 h;
  h.topLeftCorner<3, 3>() = m * Matrix3::Identity();
  h.topRightCorner<3, 3>() = -m * way;
  h.bottomLeftCorner<3, 3>() = m * way;
  h.bottomRightCorner<3, 3>() = turn_weight_ * inertia_about_centre(X_WO.rotation) - m * way * way;
  return h;
}

void BodyMotion::end(const BodyPlace& place, const Vector3& half_way) {
  const double h = time_step_;
  const Value last = evaluate(place.X_WO);
  const Vector3 centre = centre_of(place.X_WO);
  const Matrix3 rotation = orthonormalised(place.X_WO.rotation);
  const Vector3 velocity = second_order_ ? second_order_rate(centre, centre_, old_centre_, h)
                                         : Vector3((centre - centre_) / h);
  const Matrix3 rotation_rate = second_order_
                                    ? second_order_rate(rotation, rotation_, old_rotation_, h)
                                    : Matrix3((rotation - rotation_) / h);
  const double rate =
      second_order_ ? second_order_rate(place.q, now_.q, old_q_, h) : (place.q - now_.q) / h;
  // What turned it is what its inertia held against.
  momentum_ += h * (last.by_turn + half_way);
  if (turns_on_ball()) momentum_ += h * arm(rotation).cross(last.by_centre);
  old_velocity_ = velocity_;
  velocity_ = velocity;
  old_centre_ = centre_;
  centre_ = centre;
  old_rotation_ = rotation_;
  rotation_ = rotation;
  old_rotation_rate_ = rotation_rate_;
  rotation_rate_ = rotation_rate;
  old_q_ = now_.q;
  old_rate_ = rate_;
  rate_ = rate;
  now_ = place;
  now_.X_WO.rotation = rotation;
  ++steps_;
}

}  // namespace softfinger
