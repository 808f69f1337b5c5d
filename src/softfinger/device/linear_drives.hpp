#pragma once

#include <array>
#include <string>
#include <vector>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// A device whose joints are its configuration: one linear drive for each component of q, each
/// within the limits of its axis and of nothing else. What is left to a kind is its surface.
class LinearDrives : public Device {
 public:
  /// Joint limits from the limits of the settings' axes and the largest rate, m/s.
  static void set_joint_limits(DeviceSettings& settings, double max_rate);

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override;
  void clamped_joints(const Configuration& q, JointAngles& joints) const override;
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const override;
  [[nodiscard]] bool reachable(const Configuration& q) const override { return within_axes(q); }

  /// Upper limits of all axes, then lower ones.
  [[nodiscard]] int constraint_count() const override { return 2 * degrees_of_freedom(); }
  [[nodiscard]] bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                 Eigen::Ref<Eigen::MatrixXd> jacobian) const override;
  void add_constraint_curvature(const Configuration& q,
                                const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] std::span<const std::string> constraint_names(int k) const override;

  [[nodiscard]] Configuration facing(const Vector3& normal_F,
                                     const Configuration& q) const override;
  [[nodiscard]] WorkspaceSummary workspace_summary() const override;

 protected:
  /// The settings' axes and joint limits agree, see set_joint_limits.
  explicit LinearDrives(DeviceSettings settings);

 private:
  std::vector<std::string> names_;
};

}  // namespace softfinger
