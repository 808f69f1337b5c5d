#pragma once

#include <array>
#include <vector>

#include "softfinger/geometry/trajectory.hpp"
#include "softfinger/tracking/hand_skeleton.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// How a hand is to be held, at a time (s).
struct HandWaypoint {
  double time = 0.0;
  Pose X_WH;
  HandAngles angles = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero(),
                       Vector3::Zero()};
};

/// A hand that goes from waypoint to waypoint as a Trajectory does, the three angles of a finger
/// like the coordinates of a place.
class HandScript {
 public:
  /// Strictly increasing times, at least one; else throws InputError.
  HandScript(HandSide side, double size, const std::vector<HandWaypoint>& waypoints);
  /// Allocates nothing.
  [[nodiscard]] HandPose sample(double time) const;
  [[nodiscard]] double end_time() const { return wrist_.end_time(); }

 private:
  HandSide side_;
  double size_;
  Trajectory wrist_;
  std::vector<Trajectory> angles_;  ///< thumb first; as translations, rad
};

/// A finger of such a hand; never lost. Ends with the script.
class HandScriptTracker final : public Tracker {
 public:
  HandScriptTracker(HandScript script, HandFinger finger);
  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return script_.end_time(); }

 private:
  HandScript script_;
  std::size_t finger_;
};

}  // namespace softfinger
