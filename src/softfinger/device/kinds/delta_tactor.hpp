#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/device/kinematics.hpp"

namespace softfinger {

/// Sizes of a delta mechanism with a spherical tip, m.
struct DeltaTactorGeometry {
  double base_radius = 0.0;      ///< base joints' circle
  double platform_radius = 0.0;  ///< forearm joints' circle
  double crank = 0.0;            ///< driven link
  double forearm = 0.0;          ///< parallelogram from crank to platform
  double neutral_height = 0.0;   ///< of the neutral platform over the base plane
  double tip_radius = 0.0;
};

/// A small ball carried by three legs with parallelogram forearms, which keep it from turning:
/// q = (x, y, z) of the ball's centre in B', which coincides with the centre of the platform's
/// joints. The base lies below, away from the finger, at z = -neutral_height; legs at azimuth 0,
/// 120, 240 degrees, joint angles from the outward radius towards the finger, knees outward. After
/// Schorr, Okamura, "Fingertip tactile devices for virtual object manipulation and exploration",
/// CHI 2017; kinematics after Clavel, "Delta, a fast robot with parallel geometry", 1988.
class DeltaTactor final : public Kinematics {
 public:
  /// The settings come with the axes of the kind.
  DeltaTactor(const DeviceSettings& settings, const DeltaTactorGeometry& geometry);

  [[nodiscard]] static std::vector<ConfigurationAxis> axes_for(const DeltaTactorGeometry& geometry);
  [[nodiscard]] const DeltaTactorGeometry& geometry() const { return geometry_; }

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override;
  void clamped_joints(const Configuration& q, JointAngles& joints) const override;
  /// The point where three balls of the forearms' length meet, on the finger's side.
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const override;
  [[nodiscard]] bool reachable(const Configuration& q) const override;
  /// det d(joints)/dq over its value at home; 0 where legs do not reach.
  [[nodiscard]] double singularity_ratio(const Configuration& q) const;

  [[nodiscard]] int constraint_count() const override { return kConstraints; }
  [[nodiscard]] bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                 Eigen::Ref<Eigen::MatrixXd> jacobian) const override;
  void add_constraint_curvature(const Configuration& q,
                                const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] std::span<const std::string> constraint_names(int k) const override;

  [[nodiscard]] int approach_axis() const override { return 2; }
  /// Of the ball's centre.
  [[nodiscard]] Pose pose(const Configuration& q) const override;
  [[nodiscard]] RigidMotion motion(const Configuration& q) const override;
  [[nodiscard]] int leg_count() const override { return 3; }
  void linkage(const Configuration& q, std::span<Vector3> points_F) const override;

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<DeltaTactor>(*this);
  }
  // Joints above max, joints below min, legs too long, each for legs 1 to 3.
  static constexpr int kConstraints = 9;

  /// One leg in its own plane: x outward, y aside, z towards the finger, from the base joint to the
  /// platform's.
  struct Leg {
    Vector3 to_platform;
    Vector3 outward, aside;  ///< x and y axes in B'
  };
  [[nodiscard]] Leg leg(const Configuration& q, int i) const;
  /// Crank angle; false where the leg does not reach (then with the arccosine's argument cut).
  [[nodiscard]] bool crank_angle(const Vector3& to_platform, double& angle) const;
  /// Derivative of the crank angle by q.
  [[nodiscard]] Vector3 crank_rate(const Leg& leg, double angle) const;

  [[nodiscard]] std::vector<AxisReach> reaches() const override;

  DeltaTactorGeometry geometry_;
  double home_determinant_ = 0.0;
  std::array<std::string, 3> names_{"joint_1", "joint_2", "joint_3"};
};

}  // namespace softfinger
