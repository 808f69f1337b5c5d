#include "softfinger/tracking/conditioning/interpolated_tracker.hpp"

#include <algorithm>
#include <utility>

namespace softfinger {
namespace {

constexpr double kWindow = 1.0;  // s
/// Where less delay is needed than there is, the motion plays faster by this much.
constexpr double kCatchUp = 0.03;
/// Of so many of the last intervals the median is the sender's: of poses that get lost it knows
/// nothing, unlike the mean.
constexpr std::size_t kMedianOf = 15;
constexpr std::size_t kMedianOfAtLeast = 5;

}  // namespace

void InterpolatedTracker::begin_anew(const TrackedPose& pose, double time) {
  count_ = 0;
  moment_ = pose.time;
  delay_ = 0.0;
  this_second_ = last_second_ = {};
  second_began_ = time;
}

/// A pose has come: up to the last look the one before had to do.
void InterpolatedTracker::note_arrival(const TrackedPose& pose, double time) {
  if (time - second_began_ > kWindow) {
    last_second_ = std::exchange(this_second_, {});
    second_began_ = time;
  }
  this_second_.needed = std::max(this_second_.needed, time_ - seen(0).pose.time);
  this_second_.least_age = std::min(this_second_.least_age, time - pose.time);
}

/// s; 0 where too few poses came to tell. Slower than kMostDelay no sender is played evenly.
double InterpolatedTracker::median_interval() const {
  const std::size_t count = std::min(count_ - 1, kMedianOf);
  if (count < kMedianOfAtLeast) return 0.0;
  std::array<double, kMedianOf> intervals{};
  for (std::size_t i = 0; i < count; ++i) intervals[i] = seen(i).stamp - seen(i + 1).stamp;
  const auto middle = intervals.begin() + count / 2;
  std::nth_element(intervals.begin(), middle, intervals.begin() + count);
  return std::clamp(*middle, 0.0, kMostDelay);
}

/// When a pose was true that comes after the newest.
double InterpolatedTracker::even_time(double stamp) const {
  const double soonest = seen(0).pose.time + kLeastShare * interval_;
  return std::max(stamp, std::min(soonest, stamp + kMostShift));
}

void InterpolatedTracker::take(const TrackedPose& pose, double time) {
  const bool goes_on = count_ > 0 && pose.time > seen(0).pose.time - kMostShift &&
                       pose.time - seen(0).stamp <= kLostAfter;
  if (goes_on) {
    note_arrival(pose, time);
  } else {
    begin_anew(pose, time);
  }
  const double even = goes_on ? even_time(pose.time) : pose.time;
  newest_ = (newest_ + 1) % seen_.size();
  seen_[newest_] = {pose, pose.time};
  seen_[newest_].pose.time = even;
  count_ = std::min(count_ + 1, seen_.size());
  interval_ = median_interval();
}

/// As late as the next pose was, as far as that may be.
void InterpolatedTracker::adapt_delay(double elapsed) {
  const double needed = std::max(this_second_.needed, last_second_.needed);
  const double least_age = std::min(this_second_.least_age, last_second_.least_age);
  const double most =
      interval_ > 0.0 ? std::min(kMostDelay, 2.0 * interval_ + kAllowance) : kMostDelay;
  delay_ = std::min(std::max(needed, delay_ - kCatchUp * elapsed), least_age + most);
}

TrackedPose InterpolatedTracker::between(double moment) const {
  std::size_t after = 0;
  while (after + 1 < count_ && seen(after + 1).pose.time > moment) ++after;
  const TrackedPose& b = seen(after).pose;
  if (after + 1 == count_ || moment >= b.time) return b;
  const TrackedPose& a = seen(after + 1).pose;
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
  if (count_ == 0 || pose.time != seen(0).stamp) take(pose, time);
  const double elapsed = std::max(0.0, time - time_);
  time_ = time;
  adapt_delay(elapsed);
  const double wanted = std::min(time - delay_, moment_ + kMostSpeedUp * elapsed);
  moment_ = std::max(moment_, std::min(wanted, seen(0).pose.time));
  given_ = between(moment_);
  return given_;
}

}  // namespace softfinger
