#include "softfinger/tracking/make_tracker.hpp"

#include <fmt/format.h>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/tracking/csv_tracker.hpp"
#include "softfinger/tracking/natnet/natnet_tracker.hpp"
#include "softfinger/tracking/page_tracker.hpp"
#include "softfinger/tracking/scripted_tracker.hpp"
#include "softfinger/tracking/stream/osc_pose.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"
#include "softfinger/tracking/stream/pose_listener.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "softfinger/tracking/webxr_tracker.hpp"

namespace softfinger {

Pose start_pose(const std::vector<Waypoint>& waypoints) {
  if (!waypoints.empty()) return waypoints.front().pose;
  return {Matrix3::Identity(), Vector3(0.0, 0.0, 30.0 * mm)};
}

std::unique_ptr<Tracker> make_tracker(std::string_view spec,
                                      const std::filesystem::path& base_directory,
                                      const std::vector<Waypoint>& waypoints) {
  const TrackerSpec parsed = parse_tracker_spec(spec);
  if (parsed.kind == TrackerKind::kCsv) {
    return std::make_unique<CsvTracker>(read_pose_csv(base_directory / parsed.file));
  }
  if (parsed.kind == TrackerKind::kUdp || parsed.kind == TrackerKind::kOsc) {
    const Endpoint own{find_address(parsed.address), parsed.port};
    try {
      return std::make_unique<PoseListener>(
          own, parsed.kind == TrackerKind::kUdp ? decode_pose_datagram : decode_osc_pose,
          start_pose(waypoints));
    } catch (const InputError& error) {
      throw InputError(fmt::format("tracker {}: {}", spec, error.what()));
    }
  }
  if (parsed.kind == TrackerKind::kNatnet)
    return std::make_unique<NatNetTracker>(parsed, kNatNetPatience, start_pose(waypoints));
  if (parsed.kind == TrackerKind::kPage) {
    return std::make_unique<PageTracker>(start_pose(waypoints));
  }
  if (parsed.kind == TrackerKind::kWebXr) {
    return std::make_unique<WebXrTracker>(start_pose(waypoints), parsed.hand.side,
                                          parsed.hand.finger.value_or(HandFinger::kIndex));
  }
  if (waypoints.empty()) {
    throw InputError("tracker script needs at least one [[finger.waypoint]] in the scene");
  }
  return std::make_unique<ScriptedTracker>(waypoints);
}

}  // namespace softfinger
