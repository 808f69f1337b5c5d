#include "softfinger/tracking/tracker_spec.hpp"

#include "softfinger/base/error.hpp"
#include "softfinger/base/tracker_kind.hpp"
#include "softfinger/tracking/csv_tracker.hpp"
#include "softfinger/tracking/scripted_tracker.hpp"

namespace softfinger {

std::unique_ptr<Tracker> make_tracker(std::string_view spec,
                                      const std::filesystem::path& base_directory,
                                      const std::vector<Waypoint>& waypoints) {
  const TrackerSpec parsed = parse_tracker_spec(spec);
  if (parsed.kind == TrackerKind::kCsv) {
    return std::make_unique<CsvTracker>(read_pose_csv(base_directory / parsed.file));
  }
  if (waypoints.empty()) {
    throw InputError("tracker script needs at least one [[finger.waypoint]] in the scene");
  }
  return std::make_unique<ScriptedTracker>(waypoints);
}

}  // namespace softfinger
