#pragma once

#include <span>
#include <vector>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// The bone's body where its shape as a solid is needed: an ellipsoid along the axes of F that
/// fills the bounding box of the mesh group `bone`, m.
struct BoneEllipsoid {
  Vector3 centre = Vector3::Zero();
  Vector3 semi_axes = Vector3::Zero();

  [[nodiscard]] bool contains(const Vector3& p_F) const {
    return (p_F - centre).cwiseQuotient(semi_axes).squaredNorm() < 1.0;
  }
};
[[nodiscard]] BoneEllipsoid bone_ellipsoid(const FingerModel& model);

/// Mass moments of the bone and of the tissue tied to it, about F's origin in F.
struct BoneInertia {
  double mass = 0.0;                 ///< kg
  Vector3 first = Vector3::Zero();   ///< sum m X, kg m
  Matrix3 second = Matrix3::Zero();  ///< sum m X X^T, kg m^2
};

/// The bone's ellipsoid, homogeneous, plus the lumped masses of the tied nodes.
[[nodiscard]] BoneInertia bone_inertia(const FingerModel& model,
                                       std::span<const double> node_masses);

/// Pose of the bone and its rate: d(rotation)/dt is kept as a matrix, since inertia is written in
/// it.
struct BoneState {
  Pose X_WF;
  Vector3 velocity = Vector3::Zero();       ///< m/s
  Matrix3 rotation_rate = Matrix3::Zero();  ///< dR/dt, 1/s
};

/// Inertia of the bone and virtual coupling to the tracked pose over one implicit Euler step, as a
/// potential of the bone's pose. Rotations vary as R <- exp(theta) R.
class BonePotential {
 public:
  BonePotential(const BoneInertia& inertia, const Coupling& coupling)
      : inertia_(inertia), coupling_(coupling) {}

  void begin(const BoneState& old, const Pose& X_WFt_old, const Pose& X_WFt, double time_step);

  struct Value {
    double energy = 0.0;                             ///< J
    Vector3 by_translation = Vector3::Zero();        ///< N
    Vector3 by_rotation = Vector3::Zero();           ///< N m
    double inertia_norm = 0.0, coupling_norm = 0.0;  ///< N
  };
  [[nodiscard]] Value evaluate(const Pose& X_WF) const;

  struct Hessian {
    Matrix3 translation, translation_rotation, rotation;
  };
  /// `projected` leaves out what may be indefinite.
  [[nodiscard]] Hessian hessian(const Pose& X_WF, bool projected) const;

  /// Second derivative by rotation of sum_i x_i(theta) . f_i, minus its Gauss-Newton part, where
  /// `moments` = sum_i f_i r_i^T and r_i turns with the bone.
  [[nodiscard]] static Matrix3 geometric(const Matrix3& moments);

 private:
  BoneInertia inertia_;
  Coupling coupling_;
  double time_step_ = 1e-3;
  Vector3 predicted_translation_;
  Matrix3 predicted_rotation_;
  Pose target_;          ///< tracked pose
  Pose damping_target_;  ///< old pose carried along by the tracked motion
};

}  // namespace softfinger
