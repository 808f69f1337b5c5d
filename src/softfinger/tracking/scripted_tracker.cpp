#include "softfinger/tracking/scripted_tracker.hpp"

#include <utility>

namespace softfinger {

ScriptedTracker::ScriptedTracker(std::vector<Waypoint> waypoints)
    : trajectory_(std::move(waypoints)) {}

TrackedPose ScriptedTracker::sample(double time) {
  return {.time = time, .X_WFt = trajectory_.sample(time), .valid = true};
}

std::optional<double> ScriptedTracker::end_time() const { return trajectory_.end_time(); }

}  // namespace softfinger
