#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/device/kinematics.hpp"

namespace softfinger {

/// Sizes of a symmetric 3-RRS platform, m and rad.
struct Platform3rrsGeometry {
  double base_radius = 0.0;      ///< base joints' circle
  double platform_radius = 0.0;  ///< platform joints' circle
  double crank = 0.0;            ///< driven link, base joint to knee
  double coupler = 0.0;          ///< knee to platform joint
  double neutral_height = 0.0;   ///< base plane above the neutral platform
  double disk_radius = 0.0;
  double disk_edge_radius = 0.0;
  double max_tilt = 0.0;
};

/// Three legs (revolute driven, revolute, spherical) at azimuth 0, 120, 240 degrees carry a disk
/// that tilts and travels: q = (pitch, roll, travel). Kinematics after Tsai, "Robot Analysis",
/// 1999; the platform has no torsion, its orientation is the rotation vector (roll, pitch, 0) in
/// the neutral frame B', and its centre shifts by (rp/2)(m11 - m22), -rp m12 with the tilt. The
/// base lies on the nail side (+z), knees outward; joint angles from the outward radius towards the
/// platform.
///
/// The workspace is the connected set around home in which the legs close, joints and tilt are
/// within their limits and the determinant of d(joints)/dq keeps its sign.
class Platform3rrs final : public Kinematics {
 public:
  /// The settings come with the axes of the kind.
  Platform3rrs(const DeviceSettings& settings, const Platform3rrsGeometry& geometry);

  /// Pitch, roll and travel of a disk of this radius (m).
  [[nodiscard]] static std::vector<ConfigurationAxis> axes_for(double disk_radius);

  [[nodiscard]] const Platform3rrsGeometry& geometry() const { return geometry_; }

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override;
  void clamped_joints(const Configuration& q, JointAngles& joints) const override;
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const override;
  [[nodiscard]] bool reachable(const Configuration& q) const override;

  /// d(joints)/dq where the legs close.
  [[nodiscard]] bool joint_jacobian(const Configuration& q, Matrix3& jacobian) const;
  /// det d(joints)/dq over its value at home; 0 at a type-2 singularity, 0 where legs do not close.
  [[nodiscard]] double singularity_ratio(const Configuration& q) const;
  /// The determinant at home itself, with lengths in units of the crank: near 0, home is singular.
  [[nodiscard]] double home_determinant() const { return home_determinant_; }

  [[nodiscard]] int constraint_count() const override { return kConstraints; }
  [[nodiscard]] bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                 Eigen::Ref<Eigen::MatrixXd> jacobian) const override;
  void add_constraint_curvature(const Configuration& q,
                                const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] std::span<const std::string> constraint_names(int k) const override;

  [[nodiscard]] Configuration facing(const Vector3& normal_F,
                                     const Configuration& q) const override;
  [[nodiscard]] int approach_axis() const override { return 2; }
  [[nodiscard]] Pose pose(const Configuration& q) const override;
  [[nodiscard]] RigidMotion motion(const Configuration& q) const override;
  [[nodiscard]] int leg_count() const override { return 3; }
  void linkage(const Configuration& q, std::span<Vector3> points_F) const override;

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<Platform3rrs>(*this);
  }
  // Constraints: joint_1..3 above max, joint_1..3 below min, tilt, legs too long, legs too short,
  // singularity.
  static constexpr int kConstraints = 14;

  /// Whether legs close, joints and tilt are within limits and the determinant keeps its sign;
  /// nothing about being connected with home.
  [[nodiscard]] bool locally_reachable(const Configuration& q) const;
  [[nodiscard]] bool segment_reachable(const Configuration& from, const Configuration& to,
                                       int pieces) const;
  [[nodiscard]] bool connected_with_home(const Configuration& q) const;
  [[nodiscard]] bool newton_forward(const JointAngles& joints, Configuration& q) const;
  void explore_workspace();
  [[nodiscard]] std::optional<PlatformSpace> platform_space() const override;

  Platform3rrsGeometry geometry_;
  double home_determinant_ = 0.0;
  bool may_be_singular_ = true;  ///< some tilt within the limit comes near a singularity
  std::array<std::vector<std::string>, kConstraints> constraint_names_;

  /// Nodes of a grid over q around home; which of them are in the workspace.
  struct Grid {
    std::array<int, 3> low{}, count{};
    std::array<double, 3> spacing{};
    std::vector<std::uint8_t> inside;
    bool all_connected = true;  ///< every locally reachable node is connected with home
  } grid_;
};

/// With its disk. The settings come with the axes of the kind.
[[nodiscard]] std::shared_ptr<const Device> make_platform_3rrs(
    DeviceSettings settings, const Platform3rrsGeometry& geometry);

}  // namespace softfinger
