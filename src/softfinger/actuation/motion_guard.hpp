#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {

/// The last function before the wire. Whatever is wanted, what it gives
/// - lies in the device's workspace: joint and tilt limits, no singularity,
/// - is not advanced further than the ceiling, if there is one (where it already stands higher, as
///   after reset(), it only comes down),
/// - is at most max_rate * dt in every joint away from what it gave before,
/// - makes no joint faster than it was by more than max_acceleration * dt (a joint may always
/// stop), both of the targets as sent, after rounding to whole steps of the wire.
///
/// It moves on straight lines between configurations, not between joint angles: the tilt limit is
/// convex in q and not in the joints, so an interpolation of joint angles between two allowed poses
/// could tilt too far on the way. A wanted q outside the workspace is replaced by the last
/// reachable one on the segment from home to it; where the straight way is blocked (joint limits
/// need not be convex in q) it goes by home. Wanted values that are no numbers are ignored: it
/// holds.
///
/// Allocates nothing after construction, throws nothing.
class MotionGuard {
 public:
  /// Stands at the device's home. One servo per joint, or none (targets are then not formed), or
  /// the one that follows the device's travel (TransportSettings::follows_travel), which no
  /// rounding to the wire holds back. `ceiling`: null: none.
  MotionGuard(std::shared_ptr<const Device> device, std::span<const ServoSettings> servos,
              std::shared_ptr<const TravelCeiling> ceiling = nullptr);

  /// Takes q, which must be reachable, as where the device is.
  void reset(const Configuration& q);
  /// The next command towards `wanted`, dt (s) after the one before; dt <= 0 or NaN: no motion.
  void step(const Configuration& wanted, double dt);

  [[nodiscard]] const Configuration& configuration() const { return now_.q; }
  /// Joint angles of configuration(), rad.
  [[nodiscard]] const JointAngles& joints() const { return now_.joints; }
  /// Targets of the servos in the order of joints, steps of the wire.
  [[nodiscard]] std::span<const std::int32_t> targets() const {
    return std::span(now_.targets).first(servos_.size());
  }
  [[nodiscard]] std::span<const ServoMap> servos() const { return servos_; }
  /// Whether the last step reached what was wanted, or its nearest allowed.
  [[nodiscard]] bool arrived() const { return arrived_; }

 private:
  struct Command {
    Configuration q;
    JointAngles joints;
    std::array<std::int32_t, kMostServos> targets{};
  };

  /// In the workspace and below the ceiling.
  [[nodiscard]] bool allowed(const Configuration& q) const;
  /// Takes a command as the present one, dt (s) after the one before; 0: it stands there.
  void take(const Command& command, double dt);
  /// wanted, made finite and brought into the workspace, below the ceiling.
  [[nodiscard]] Configuration allowed_goal(const Configuration& wanted) const;
  /// Largest fraction of the way from the present q to `goal` that may be gone in one step.
  [[nodiscard]] double allowed_fraction(const Configuration& goal, double dt) const;
  [[nodiscard]] bool way_is_clear(const Configuration& goal) const;
  /// Part of the straight way from home to q before the first of some points on it that the device
  /// cannot reach; 1: all of it.
  [[nodiscard]] double way_from_home(const Configuration& q) const;
  [[nodiscard]] bool sees_home(const Configuration& q) const { return way_from_home(q) == 1.0; }
  /// Whether the next q is hardly away from the present one, since something is in the way.
  [[nodiscard]] bool is_blocked(const Configuration& next, const Configuration& goal,
                                double dt) const;
  /// Forms the command for q; false where it would break a limit once rounded.
  bool form(const Configuration& q, Command& command) const;
  /// The same for the first q that fits, going a little towards home; false: none does.
  template <typename Fits>
  bool form_near(const Configuration& q, Command& command, const Fits& fits) const;
  /// Joint travel allowed in dt towards larger (up) or smaller values, less what rounding of two
  /// commands may add.
  [[nodiscard]] double allowed_travel(Eigen::Index joint, bool up, double dt) const;
  [[nodiscard]] bool within_travel(const JointAngles& joints, double dt) const;

  std::shared_ptr<const Device> device_;
  std::vector<ServoMap> servos_;
  std::shared_ptr<const TravelCeiling> ceiling_;
  std::optional<int>
      travel_axis_;           ///< of q, that the one servo follows; none: servos follow joints
  double most_excess_ = 0.0;  ///< over the ceiling, that is no reason to refuse; SI
  Command now_;
  JointAngles rates_;  ///< of the last step, per s
  bool by_home_ = false;
  bool arrived_ = true;
};

}  // namespace softfinger
