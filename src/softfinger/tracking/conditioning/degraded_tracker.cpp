#include "softfinger/tracking/conditioning/degraded_tracker.hpp"

#include <cmath>
#include <utility>

namespace softfinger {

DegradedTracker::DegradedTracker(Motion motion, const TrackingQuality& quality)
    : motion_(std::move(motion)), quality_(quality), random_(quality.seed) {}

TrackedPose DegradedTracker::sample(double time) {
  const double taken = std::floor((time - quality_.age) * quality_.rate) / quality_.rate;
  if (taken < 0.0 || (pose_.valid && taken <= pose_.time)) return pose_;
  pose_ = {.time = taken, .arrival = time, .X_WFt = motion_(taken), .valid = true};
  std::normal_distribution<double> error;
  const auto vector = [&](double deviation) {
    Vector3 result;
    for (double& coordinate : result) coordinate = deviation * error(random_);
    return result;
  };
  pose_.X_WFt.translation += vector(quality_.noise);
  pose_.X_WFt.rotation *= exp_rotation(vector(quality_.turn_noise));
  return pose_;
}

}  // namespace softfinger
