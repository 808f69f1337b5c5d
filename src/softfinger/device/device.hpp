#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "softfinger/device/contacting_surface.hpp"
#include "softfinger/device/device_settings.hpp"
#include "softfinger/device/kinematics.hpp"
#include "softfinger/device/surface_samples.hpp"

namespace softfinger {

/// A device that touches the wearer's finger, as matching, actuation and the twin know it: a
/// contacting surface, and the kinematics that moves it. What each function gives is said there.
/// Immutable and shared by threads. Nothing but the constructor and mounted() allocates or throws.
class Device {
 public:
  /// The kinematics is made of the same settings.
  Device(DeviceSettings settings, std::unique_ptr<const Kinematics> kinematics,
         std::shared_ptr<const ContactingSurface> surface)
      : settings_(std::move(settings)),
        kinematics_(std::move(kinematics)),
        surface_(std::move(surface)) {}
  /// The same device, its mount as DeviceSettings::mount_fit says.
  [[nodiscard]] std::shared_ptr<const Device> mounted(const Pose& mount_fit) const;

  [[nodiscard]] const DeviceSettings& settings() const { return settings_; }
  [[nodiscard]] const std::string& kind() const { return settings_.kind; }
  [[nodiscard]] const Kinematics& kinematics() const { return *kinematics_; }
  [[nodiscard]] const ContactingSurface& surface() const { return *surface_; }

  [[nodiscard]] int degrees_of_freedom() const { return static_cast<int>(settings_.axes.size()); }
  [[nodiscard]] int joint_count() const {
    return static_cast<int>(settings_.joint_limits.min.size());
  }
  [[nodiscard]] std::span<const ConfigurationAxis> axes() const { return settings_.axes; }
  [[nodiscard]] const Configuration& home() const { return settings_.home; }
  [[nodiscard]] const Configuration& retracted() const { return settings_.retracted; }
  [[nodiscard]] const JointLimits& joint_limits() const { return settings_.joint_limits; }
  /// Squared distance of two configurations in the metric of the axes, m^2.
  [[nodiscard]] double squared_distance(const Configuration& a, const Configuration& b) const;

  // What the kinematics knows.

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const {
    return kinematics_->inverse_kinematics(q, joints);
  }
  void clamped_joints(const Configuration& q, JointAngles& joints) const {
    kinematics_->clamped_joints(q, joints);
  }
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const {
    return kinematics_->forward_kinematics(joints, q);
  }
  [[nodiscard]] bool reachable(const Configuration& q) const { return kinematics_->reachable(q); }
  [[nodiscard]] int constraint_count() const { return kinematics_->constraint_count(); }
  [[nodiscard]] bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                 Eigen::Ref<Eigen::MatrixXd> jacobian) const {
    return kinematics_->constraints(q, values, jacobian);
  }
  void add_constraint_curvature(const Configuration& q,
                                const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                Eigen::Ref<Eigen::MatrixXd> hessian) const {
    kinematics_->add_constraint_curvature(q, multipliers, hessian);
  }
  [[nodiscard]] std::span<const std::string> constraint_names(int k) const {
    return kinematics_->constraint_names(k);
  }
  [[nodiscard]] Configuration facing(const Vector3& normal_F, const Configuration& q) const {
    return kinematics_->facing(normal_F, q);
  }
  [[nodiscard]] int approach_axis() const { return kinematics_->approach_axis(); }
  [[nodiscard]] bool advances() const { return kinematics_->advances(); }
  void advance(double distance, Configuration& q) const { kinematics_->advance(distance, q); }
  [[nodiscard]] int leg_count() const { return kinematics_->leg_count(); }
  void linkage(const Configuration& q, std::span<Vector3> points_F) const {
    kinematics_->linkage(q, points_F);
  }
  [[nodiscard]] WorkspaceSummary workspace_summary() const {
    return kinematics_->workspace_summary();
  }
  [[nodiscard]] WorkspaceOutline workspace_outline() const {
    return kinematics_->workspace_outline();
  }

  // What the surface knows, where the kinematics takes it.

  [[nodiscard]] ClosestPointResidual closest_point_residual(const Configuration& q,
                                                            const Vector3& p_F) const {
    return surface_->closest_point_residual(*kinematics_, q, p_F);
  }
  [[nodiscard]] SurfaceDistance signed_distance(const Configuration& q, const Vector3& p_F) const {
    return surface_->signed_distance(*kinematics_, q, p_F);
  }
  [[nodiscard]] double deviation(const Configuration& q, const SurfaceSamples& samples) const {
    return surface_->deviation(*kinematics_, q, samples);
  }
  double deviation_derivatives(const Configuration& q, const SurfaceSamples& samples,
                               Eigen::Ref<Eigen::VectorXd> gradient,
                               Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                               Eigen::Ref<Eigen::MatrixXd> hessian) const {
    return surface_->deviation_derivatives(*kinematics_, q, samples, gradient, gauss_newton,
                                           hessian);
  }
  [[nodiscard]] double least_distance(const Configuration& q, const SurfaceSamples& samples) const {
    return surface_->least_distance(*kinematics_, q, samples);
  }
  /// Pose of the contacting surface's frame P in F; z towards the finger.
  [[nodiscard]] Pose surface_pose(const Configuration& q) const {
    return surface_->pose(*kinematics_, q);
  }
  [[nodiscard]] int solid_piece_count() const { return surface_->solid_piece_count(); }
  void solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const {
    surface_->solid_pieces(*kinematics_, q, pieces);
  }
  [[nodiscard]] const PinField* pin_field() const { return surface_->pin_field(); }
  [[nodiscard]] double disk_radius() const { return surface_->disk_radius(); }
  [[nodiscard]] double disk_edge_radius() const { return surface_->disk_edge_radius(); }
  [[nodiscard]] double cap_radius() const { return surface_->cap_radius(); }

 private:
  DeviceSettings settings_;
  std::unique_ptr<const Kinematics> kinematics_;
  std::shared_ptr<const ContactingSurface> surface_;
};

}  // namespace softfinger
