#include "softfinger/finger/bone.hpp"

#include <cmath>

namespace softfinger {
namespace {

/// k such that that the symmetric part of d log(exp(theta) R) / d theta is I + k [phi]^2, phi = log
/// R.
double log_curvature(double angle) {
  if (angle < 1e-3) return 1.0 / 12.0;
  return 1.0 / (angle * angle) - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
}

Matrix3 half_squared_angle_hessian(const Vector3& phi, bool projected) {
  Matrix3 h = Matrix3::Identity();
  if (projected) return h;
  const Matrix3 s = skew(phi);
  h += log_curvature(phi.norm()) * s * s;
  return h;
}

}  // namespace

BoneEllipsoid bone_ellipsoid(const FingerModel& model) {
  Eigen::AlignedBox3d box;
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const auto surface = static_cast<std::size_t>(model.mesh.triangle_surface[t]);
    if (model.mesh.surface_names[surface] != "bone") continue;
    for (int node : model.mesh.triangles[t]) {
      box.extend(model.mesh.nodes[static_cast<std::size_t>(node)]);
    }
  }
  return {box.center(), 0.5 * box.sizes()};
}

BoneInertia bone_inertia(const FingerModel& model, std::span<const double> node_masses) {
  const BoneEllipsoid bone = bone_ellipsoid(model);
  BoneInertia inertia;
  inertia.mass = model.bone_mass;
  inertia.first = model.bone_mass * bone.centre;
  inertia.second = model.bone_mass * (bone.centre * bone.centre.transpose());
  inertia.second.diagonal() += model.bone_mass / 5.0 * bone.semi_axes.cwiseAbs2();
  for (std::size_t n = 0; n < model.mesh.nodes.size(); ++n) {
    if (!model.node_is_rigid[n]) continue;
    const Vector3& x = model.mesh.nodes[n];
    inertia.mass += node_masses[n];
    inertia.first += node_masses[n] * x;
    inertia.second += node_masses[n] * x * x.transpose();
  }
  return inertia;
}

void BonePotential::begin(const BoneState& old, const Pose& X_WFt_old, const Pose& X_WFt,
                          double time_step) {
  time_step_ = time_step;
  predicted_translation_ = old.X_WF.translation + time_step * old.velocity;
  predicted_rotation_ = old.X_WF.rotation + time_step * old.rotation_rate;
  target_ = X_WFt;
  damping_target_.translation = old.X_WF.translation + X_WFt.translation - X_WFt_old.translation;
  damping_target_.rotation = X_WFt.rotation * X_WFt_old.rotation.transpose() * old.X_WF.rotation;
}

BonePotential::Value BonePotential::evaluate(const Pose& X_WF) const {
  Value v;
  const double w = 1.0 / (time_step_ * time_step_);
  const Vector3 dc = X_WF.translation - predicted_translation_;
  const Matrix3 dR = X_WF.rotation - predicted_rotation_;
  const Vector3 by_c = w * (inertia_.mass * dc + dR * inertia_.first);
  const Matrix3 by_R = w * (dc * inertia_.first.transpose() + dR * inertia_.second);
  v.energy = 0.5 * (dc.dot(by_c) + by_R.cwiseProduct(dR).sum());
  v.by_translation = by_c;
  v.by_rotation = vee(by_R * X_WF.rotation.transpose());
  v.inertia_norm = by_c.norm();

  const double damping = 1.0 / time_step_;
  const Vector3 stretch = X_WF.translation - target_.translation;
  const Vector3 drag = X_WF.translation - damping_target_.translation;
  const Vector3 phi = log_rotation(X_WF.rotation * target_.rotation.transpose());
  const Vector3 psi = log_rotation(X_WF.rotation * damping_target_.rotation.transpose());
  const Vector3 force =
      coupling_.translation_stiffness * stretch + damping * coupling_.translation_damping * drag;
  v.energy += 0.5 * (coupling_.translation_stiffness * stretch.squaredNorm() +
                     damping * coupling_.translation_damping * drag.squaredNorm() +
                     coupling_.rotation_stiffness * phi.squaredNorm() +
                     damping * coupling_.rotation_damping * psi.squaredNorm());
  v.by_translation += force;
  // The rotation vector is an eigenvector of the derivative of the logarithm.
  v.by_rotation += coupling_.rotation_stiffness * phi + damping * coupling_.rotation_damping * psi;
  v.coupling_norm = force.norm();
  return v;
}

Matrix3 BonePotential::geometric(const Matrix3& moments) {
  return 0.5 * (moments + moments.transpose()) - moments.trace() * Matrix3::Identity();
}

BonePotential::Hessian BonePotential::hessian(const Pose& X_WF, bool projected) const {
  const double w = 1.0 / (time_step_ * time_step_);
  const double damping = 1.0 / time_step_;
  const Matrix3& R = X_WF.rotation;
  Hessian h;
  h.translation = (w * inertia_.mass + coupling_.translation_stiffness +
                   damping * coupling_.translation_damping) *
                  Matrix3::Identity();
  h.translation_rotation = -w * skew(R * inertia_.first);
  const Matrix3 second_W = R * inertia_.second * R.transpose();
  h.rotation = w * (second_W.trace() * Matrix3::Identity() - second_W);
  if (!projected) {
    const Vector3 dc = X_WF.translation - predicted_translation_;
    const Matrix3 by_R =
        w * (dc * inertia_.first.transpose() + (R - predicted_rotation_) * inertia_.second);
    h.rotation += geometric(by_R * R.transpose());
  }
  const Vector3 phi = log_rotation(R * target_.rotation.transpose());
  const Vector3 psi = log_rotation(R * damping_target_.rotation.transpose());
  h.rotation += coupling_.rotation_stiffness * half_squared_angle_hessian(phi, projected) +
                damping * coupling_.rotation_damping * half_squared_angle_hessian(psi, projected);
  return h;
}

}  // namespace softfinger
