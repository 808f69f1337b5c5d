#include "softfinger/tracking/recorded_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/base/error.hpp"

namespace softfinger {

RecordedTracker::RecordedTracker(std::vector<TrackedPose> poses, double time_step)
    : poses_(std::move(poses)), time_step_(time_step) {
  if (poses_.empty()) throw InputError("the recording has no tracked poses");
}

TrackedPose RecordedTracker::sample(double time) {
  const auto last = static_cast<double>(poses_.size() - 1);
  const double step = std::clamp(std::round(time / time_step_), 0.0, last);
  return poses_[static_cast<std::size_t>(step)];
}

std::optional<double> RecordedTracker::end_time() const {
  return static_cast<double>(poses_.size() - 1) * time_step_;
}

}  // namespace softfinger
