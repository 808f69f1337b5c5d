#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softfinger/device/kinematics.hpp"

namespace softfinger {

/// A kinematics whose joints are its configuration: one linear drive for each component of q, each
/// within the limits of its axis and of nothing else.
class LinearDrives : public Kinematics {
 public:
  /// Joint limits from the limits of the settings' axes and the largest rate, m/s.
  static void set_joint_limits(DeviceSettings& settings, double max_rate);

  /// The settings' axes and joint limits agree, see set_joint_limits. `directions`: in which each
  /// drive moves what carries the surface, unit, in B'; zero for those that change its shape
  /// instead, as all do where none is given. With directions at most RigidMotion::kMostAxes drives.
  LinearDrives(const DeviceSettings& settings, std::vector<Vector3> directions, int approach_axis);

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override;
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const override;
  [[nodiscard]] bool reachable(const Configuration& q) const override { return within_axes(q); }

  /// Upper limits of all axes, then lower ones.
  [[nodiscard]] int constraint_count() const override { return 2 * degrees_of_freedom(); }
  [[nodiscard]] bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                 Eigen::Ref<Eigen::MatrixXd> jacobian) const override;
  [[nodiscard]] std::span<const std::string> constraint_names(int k) const override;

  [[nodiscard]] int approach_axis() const override { return approach_axis_; }
  [[nodiscard]] Pose pose(const Configuration& q) const override;
  [[nodiscard]] RigidMotion motion(const Configuration& q) const override;

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<LinearDrives>(*this);
  }
  std::vector<Vector3> directions_;
  int approach_axis_;
  std::vector<std::string> names_;
};

}  // namespace softfinger
