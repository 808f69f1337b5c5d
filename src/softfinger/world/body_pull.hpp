#pragma once

#include "softfinger/contact/object_dynamics.hpp"
#include "softfinger/finger/obstacle_coupling.hpp"

namespace softfinger {

/// What pulls a part of a hand towards where it is tracked, or an object to where a person holds
/// it, over one step, as a potential of its pose: springs to the tracked pose and dampers of the
/// motion against it, which together are one spring to a pose between them. Translation of O's
/// origin and rotation are each quadratic until the pull is at its limit, and go on linearly.
class BodyPull {
 public:
  /// Tracked there at the start.
  BodyPull(const Following& following, const Pose& X_WT)
      : following_(following), X_WT_(X_WT), X_WT_old_(X_WT), centre_(X_WT) {}

  /// Tracked there from the next step on, where it was before as well: as if it had stood there.
  void put(const Pose& X_WT) { X_WT_ = X_WT_old_ = X_WT; }
  /// Tracked there at the end of the next step.
  void follow(const Pose& X_WT) { X_WT_ = X_WT; }
  /// A step of time_step (s) begins with the part at X_WO.
  void begin(double time_step, const Pose& X_WO);
  /// It has ended.
  void end() { X_WT_old_ = X_WT_; }

  struct Value {
    double energy = 0.0;                  ///< J
    Vector3 by_origin = Vector3::Zero();  ///< N
    Vector3 by_turn = Vector3::Zero();    ///< N m
  };
  [[nodiscard]] Value evaluate(const Pose& X_WO) const;
  /// Second derivative by translation of O's origin and rotation, W.
  [[nodiscard]] Matrix6 hessian(const Pose& X_WO) const;

  template <typename Hash>
  void add_to(Hash& hash) const {
    hash.add(X_WT_.rotation).add(X_WT_.translation);
    hash.add(X_WT_old_.rotation).add(X_WT_old_.translation);
  }

 private:
  Following following_;
  Pose X_WT_, X_WT_old_;
  Pose centre_;                                        ///< where the step's spring leads
  double stiffness_ = 0.0, rotation_stiffness_ = 0.0;  ///< of it, N/m and N m/rad
};

}  // namespace softfinger
