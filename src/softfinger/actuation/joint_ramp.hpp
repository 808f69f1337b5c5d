#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "softfinger/device/device.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {

/// Leads servos joint by joint to where they are when the device is retracted, none faster than its
/// rate and acceleration: the way away from a finger where no configuration says where the device
/// is, since its servos stand outside of its limits or workspace, or one of them cannot be led.
class JointRamp {
 public:
  /// `servos`: one a joint.
  JointRamp(std::shared_ptr<const Device> device, std::span<const ServoMap> servos);

  /// From where the servos stand, or were last sent; rad, or m for linear joints.
  void start(const JointAngles& standing);
  /// dt (s) further.
  void step(double dt);
  [[nodiscard]] bool is_under_way() const { return under_way_; }
  /// All joints are where they are when retracted.
  [[nodiscard]] bool arrived() const { return joints_ == goal_; }
  /// From here on something else leads the servos.
  void end() { under_way_ = false; }
  [[nodiscard]] const JointAngles& joints() const { return joints_; }
  /// Steps of the wire, one a servo; within the cuts of the servos, and never further outside of
  /// the joints' limits than they stood.
  [[nodiscard]] std::span<const std::int32_t> targets() const {
    return std::span(targets_).first(servos_.size());
  }

 private:
  void form();

  std::shared_ptr<const Device> device_;
  std::span<const ServoMap> servos_;
  JointAngles goal_, joints_, least_, largest_;
  double rate_ = 0.0;  ///< of the last step
  bool under_way_ = false;
  std::array<std::int32_t, kMostServos> targets_{};
};

}  // namespace softfinger
