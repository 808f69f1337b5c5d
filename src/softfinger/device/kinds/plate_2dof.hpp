#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/device/kinematics.hpp"
#include "softfinger/device/tilt.hpp"

namespace softfinger {

/// Sizes of a plate with two degrees of freedom, m and rad.
struct Plate2dofGeometry {
  bool rolls = false;  ///< turns by roll instead of pitch
  double lever = 0.0;  ///< racks on either side of the plate's axis
  double pinion_radius = 0.0;
  double disk_radius = 0.0;
  double disk_edge_radius = 0.0;
  double max_tilt = 0.0;
};

/// A disk that tilts about one axis through its centre and travels: q = (pitch or roll, travel).
/// Two motors drive a rack each, at the lever's length before and behind the axis: rack i stands at
/// travel -+ lever sin(tilt), its pinion at that over the pinion's radius. A plate that is turned
/// to the contact and brought against the pad, as by Frisoli, Solazzi, Salsedo, Bergamasco, "A
/// fingertip haptic display for improving curvature discrimination", Presence 17, 2008.
class Plate2dof final : public Kinematics {
 public:
  /// The settings come with the axes of the kind.
  Plate2dof(const DeviceSettings& settings, const Plate2dofGeometry& geometry);

  /// Their limits from those of the joints.
  [[nodiscard]] static std::vector<ConfigurationAxis> axes_for(const Plate2dofGeometry& geometry,
                                                               const JointLimits& limits);
  [[nodiscard]] const Plate2dofGeometry& geometry() const { return geometry_; }

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override;
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const override;
  [[nodiscard]] bool reachable(const Configuration& q) const override;

  [[nodiscard]] int constraint_count() const override { return kConstraints; }
  [[nodiscard]] bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                 Eigen::Ref<Eigen::MatrixXd> jacobian) const override;
  void add_constraint_curvature(const Configuration& q,
                                const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] std::span<const std::string> constraint_names(int k) const override;

  [[nodiscard]] Configuration facing(const Vector3& normal_F,
                                     const Configuration& q) const override;
  [[nodiscard]] int approach_axis() const override { return 1; }
  [[nodiscard]] Pose pose(const Configuration& q) const override;
  [[nodiscard]] RigidMotion motion(const Configuration& q) const override;

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<Plate2dof>(*this);
  }
  // Joints 1 and 2 above max, joints 1 and 2 below min, tilt above and below.
  static constexpr int kConstraints = 6;

  [[nodiscard]] std::optional<PlatformSpace> platform_space() const override;
  [[nodiscard]] Tilt tilt(const Configuration& q) const;
  [[nodiscard]] double side(int joint) const { return joint == 0 ? 1.0 : -1.0; }

  Plate2dofGeometry geometry_;
  std::array<std::string, kConstraints> names_;
};

}  // namespace softfinger
