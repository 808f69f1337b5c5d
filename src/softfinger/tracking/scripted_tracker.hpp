#pragma once

#include <vector>

#include "softfinger/geometry/trajectory.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// A finger that follows the waypoints of a scene; never lost. Ends with the last waypoint.
class ScriptedTracker final : public Tracker {
 public:
  /// X_WFt at strictly increasing times, at least one.
  explicit ScriptedTracker(std::vector<Waypoint> waypoints);
  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override;

 private:
  Trajectory trajectory_;
};

}  // namespace softfinger
