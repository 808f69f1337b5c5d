#include "softfinger/tracking/hand_script.hpp"

#include <utility>

namespace softfinger {
namespace {

Trajectory wrist_of(const std::vector<HandWaypoint>& waypoints) {
  std::vector<Waypoint> places;
  places.reserve(waypoints.size());
  for (const HandWaypoint& each : waypoints) places.push_back({each.time, each.X_WH});
  return Trajectory(std::move(places));
}

Trajectory angles_of(const std::vector<HandWaypoint>& waypoints, std::size_t finger) {
  std::vector<Waypoint> places;
  places.reserve(waypoints.size());
  for (const HandWaypoint& each : waypoints) {
    places.push_back({each.time, {Matrix3::Identity(), each.angles.at(finger)}});
  }
  return Trajectory(std::move(places));
}

}  // namespace

HandScript::HandScript(HandSide side, double size, const std::vector<HandWaypoint>& waypoints)
    : side_(side), size_(size), wrist_(wrist_of(waypoints)) {
  for (std::size_t f = 0; f < kHandFingers.size(); ++f) angles_.push_back(angles_of(waypoints, f));
}

HandPose HandScript::sample(double time) const {
  HandAngles angles;
  for (std::size_t f = 0; f < angles.size(); ++f) angles[f] = angles_[f].sample(time).translation;
  return hand_pose(side_, size_, wrist_.sample(time), angles);
}

HandScriptTracker::HandScriptTracker(HandScript script, HandFinger finger)
    : script_(std::move(script)), finger_(static_cast<std::size_t>(finger)) {}

TrackedPose HandScriptTracker::sample(double time) {
  TrackedPose tracked;
  tracked.time = time;
  tracked.X_WFt = script_.sample(time).distal.at(finger_);
  tracked.valid = true;
  return tracked;
}

}  // namespace softfinger
