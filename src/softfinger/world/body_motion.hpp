#pragma once

#include <span>

#include "softfinger/world/body_tree.hpp"

namespace softfinger {

/// How a body moved up to now, and from it where the next step would lead without forces: its
/// inertia over one step as a potential of its pose.
///
/// A step is implicit Euler, or where nothing touched for some steps the second backward
/// differentiation formula, whose potential is the same with the weight 9 m / 4 h^2 about
/// (4 x_n - x_n-1) / 3 + (2 h / 3) (4 v_n - v_n-1) / 3. The turn of a free body is predicted by its
/// angular momentum, R_n exp(h I^-1 L), which leaves free spin as it is, and that of a body on a
/// ball joint at rest by its angular momentum about that; what else is jointed to something at rest
/// by its joint's rate; what is jointed to something that moves by its points,
/// whose motion is that of R's columns.
class BodyMotion {
 public:
  /// At rest, or with the velocity that the scene gives it: `tree` says how much of it a joint
  /// allows.
  BodyMotion(const Body& body, const BodyPlace& start, const Vector3& velocity_W,
             const Vector3& angular_velocity_W, double rate);

  /// At rest there from now on.
  void rest_at(const Pose& X_WO);

  /// At rest where it is.
  void rest();

  /// Before a step of time_step (s). `smooth`: nothing touched the body of late.
  void begin(double time_step, bool smooth);
  /// Where the step leads without forces: q, turn, pose. What is jointed is to be put on its
  /// parent.
  [[nodiscard]] BodyPlace prediction() const { return predicted_; }
  /// The prediction as put on its parent, for what is jointed.
  void refer_to(const Pose& X_WO_predicted);

  struct Value {
    double energy = 0.0;                  ///< J
    Vector3 by_centre = Vector3::Zero();  ///< N
    Vector3 by_turn = Vector3::Zero();    ///< about the centre of mass, N m
  };
  [[nodiscard]] Value evaluate(const Pose& X_WO) const;
  /// Second derivative by translation of O's origin and rotation, W.
  [[nodiscard]] Matrix6 hessian(const Pose& X_WO) const;

  /// The step led there. `half_way`: what forces turned the body by about pivot() half way
  /// through the step, beyond what they do at its end, N m, W.
  void end(const BodyPlace& place, const Vector3& half_way = Vector3::Zero());

  /// The point about which its angular momentum is, O.
  [[nodiscard]] Vector3 pivot() const {
    return turns_on_ball() ? body_.joint->point_O : body_.inertia.centre_O;
  }
  /// Of the inertia per mass, 1/s^2.
  [[nodiscard]] double weight() const { return weight_; }
  [[nodiscard]] const BodyPlace& place() const { return now_; }
  [[nodiscard]] const Vector3& velocity() const { return velocity_; }  ///< of the centre, m/s
  [[nodiscard]] Vector3 angular_velocity() const;                      ///< W, rad/s
  /// All that the next step depends on.
  template <typename Hash>
  void add_to(Hash& hash) const {
    hash.add(now_.X_WO.rotation).add(now_.X_WO.translation).add(now_.q).add(now_.turn);
    hash.add(velocity_).add(old_velocity_).add(centre_).add(old_centre_);
    hash.add(old_rotation_).add(old_rotation_rate_).add(old_q_);
    hash.add(momentum_).add(rotation_rate_).add(rate_).add(old_rate_).add(steps_);
  }

 private:
  [[nodiscard]] Vector3 centre_of(const Pose& X_WO) const { return X_WO * body_.inertia.centre_O; }
  [[nodiscard]] bool by_joint() const {
    return body_.joint && body_.stands_still && body_.parent < 0;
  }
  [[nodiscard]] bool turns_on_ball() const {
    return by_joint() && body_.joint->kind == JointKind::kBall;
  }
  [[nodiscard]] Matrix3 inertia_about_centre(const Matrix3& R_WO) const;
  /// Of a ball joint, from its point to the centre of mass, W.
  [[nodiscard]] Vector3 arm(const Matrix3& R_WO) const {
    return R_WO * (body_.inertia.centre_O - body_.joint->point_O);
  }
  /// About what a body's momentum is: its centre of mass, or the point of its ball joint.
  [[nodiscard]] Matrix3 inertia(const Matrix3& R_WO) const;
  /// By its momentum, half way, where the axes of inertia are the step's on average.
  [[nodiscard]] Vector3 mean_spin() const;

  Body body_;
  BodyPlace now_, predicted_;
  double time_step_ = 1e-3;
  bool second_order_ = false;
  int steps_ = 0;
  // Of the centre of mass, now and a step ago.
  Vector3 centre_, old_centre_, velocity_, old_velocity_;
  Matrix3 rotation_, old_rotation_, rotation_rate_, old_rotation_rate_;  ///< R and dR/dt
  Vector3 momentum_;                                  ///< angular, W, N m s, see inertia()
  double old_q_ = 0.0, rate_ = 0.0, old_rate_ = 0.0;  ///< of q
  // What the potential refers to.
  Vector3 reference_centre_;
  Matrix3 reference_rotation_;
  double weight_ = 1e6, turn_weight_ = 1e6;  ///< 1/s^2
};

}  // namespace softfinger
