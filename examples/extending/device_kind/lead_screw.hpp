#pragma once

#include <memory>

#include "softfinger/device/device.hpp"
#include "softfinger/device/kinds/device_kinds.hpp"

namespace softfinger {

/// A nut on a screw that one motor turns: q = (travel), the joint the screw's angle.
class LeadScrew final : public Kinematics {
 public:
  /// `lead`: travel of a full turn, m, > 0. The settings come with the axis and the joint's limits.
  LeadScrew(const DeviceSettings& settings, double lead);

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override;
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const override;
  [[nodiscard]] bool reachable(const Configuration& q) const override { return within_axes(q); }
  [[nodiscard]] int approach_axis() const override { return 0; }
  [[nodiscard]] Pose pose(const Configuration& q) const override;
  [[nodiscard]] RigidMotion motion(const Configuration& q) const override;

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<LeadScrew>(*this);
  }

  double travel_per_rad_;
};

/// Its row of the table in device/kinds/device_kinds.cpp: a disk on such a nut.
[[nodiscard]] const DeviceKind& lead_screw_kind();

}  // namespace softfinger
