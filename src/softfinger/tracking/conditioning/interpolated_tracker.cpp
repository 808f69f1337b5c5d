#include "softfinger/tracking/conditioning/interpolated_tracker.hpp"

#include <algorithm>

namespace softfinger {
namespace {

constexpr double kWindow = 1.0;  // s
/// Where less delay is needed than there is, the motion plays faster by this much.
constexpr double kCatchUp = 0.03;

}  // namespace

void InterpolatedTracker::take(const TrackedPose& pose, double time) {
  const double interval = count_ > 0 ? pose.time - seen(0).time : 0.0;
  if (count_ == 0 || !(interval > 0.0) || interval > kLostAfter) {
    count_ = 0;
    delay_ = needed_ = needed_before_ = 0.0;
    window_began_ = time;
  } else {
    // Up to the last look the pose before had to do.
    const double needed = time_ - seen(0).time;
    if (time - window_began_ > kWindow) {
      needed_before_ = needed_;
      needed_ = 0.0;
      window_began_ = time;
    }
    needed_ = std::max(needed_, needed);
    delay_ = std::max(delay_, needed);
  }
  newest_ = (newest_ + 1) % seen_.size();
  seen_[newest_] = pose;
  count_ = std::min(count_ + 1, seen_.size());
}

TrackedPose InterpolatedTracker::between(double moment) const {
  std::size_t after = 0;
  while (after + 1 < count_ && seen(after + 1).time > moment) ++after;
  if (after + 1 == count_ || moment >= seen(after).time) return seen(after);
  const TrackedPose& a = seen(after + 1);
  const TrackedPose& b = seen(after);
  const double share = (moment - a.time) / (b.time - a.time);
  TrackedPose pose = b;
  pose.time = moment;
  pose.arrival = a.arrival + share * (b.arrival - a.arrival);
  pose.X_WFt = interpolate(a.X_WFt, b.X_WFt, share);
  return pose;
}

TrackedPose InterpolatedTracker::sample(double time) {
  TrackedPose pose = source_->sample(time);
  if (!pose.valid) {
    if (!known_) return pose;  // where the finger waits for the first
    count_ = 0;
    given_.valid = false;
    return given_;
  }
  known_ = true;
  if (count_ == 0 || pose.time != seen(0).time) take(pose, time);
  const double enough = std::max(needed_, needed_before_);
  delay_ = std::max(enough, delay_ - kCatchUp * std::max(0.0, time - time_));
  time_ = time;
  const double moment = std::clamp(time - delay_, seen(0).time - kMostDelay, seen(0).time);
  given_ = between(moment);
  return given_;
}

}  // namespace softfinger
