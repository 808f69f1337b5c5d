#include "softfinger/tracking/conditioning/conditioning_effect.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

namespace softfinger {
namespace {

constexpr double kLookEvery = 1e-3;    // s
constexpr double kSpeedWindow = 0.05;  // s, over which a speed is taken

bool rests(const DegradedTracker::Motion& motion, double time) {
  const Pose before = motion(time - 0.5 * kSpeedWindow);
  const Pose after = motion(time + 0.5 * kSpeedWindow);
  const double turn = log_rotation(before.rotation.transpose() * after.rotation).norm();
  return (after.translation - before.translation).norm() <
             ConditioningEffect::kRestSpeed * kSpeedWindow &&
         turn < ConditioningEffect::kRestTurnRate * kSpeedWindow;
}

void add_squares(const Pose& pose, const Pose& truth, PoseError& sum) {
  sum.distance += (pose.translation - truth.translation).squaredNorm();
  sum.turn += log_rotation(truth.rotation.transpose() * pose.rotation).squaredNorm();
}

void conclude(ConditioningEffect::Part& part) {
  const double count = std::max(1.0, std::round(part.time / kLookEvery));
  for (PoseError* sum : {&part.before, &part.after}) {
    sum->distance = std::sqrt(sum->distance / count);
    sum->turn = std::sqrt(sum->turn / count);
  }
}

}  // namespace

ConditioningEffect conditioning_effect(const DegradedTracker::Motion& motion, double duration,
                                       const TrackingQuality& quality,
                                       const PoseConditioning& conditioning) {
  const auto plain =
      conditioned(std::make_unique<DegradedTracker>(motion, quality), PoseConditioning{}, true);
  const auto changed =
      conditioned(std::make_unique<DegradedTracker>(motion, quality), conditioning, true);
  const double lead = conditioning.lead.value_or(0.0);
  ConditioningEffect effect;
  const auto looks = static_cast<std::int64_t>(duration / kLookEvery);
  for (std::int64_t look = 0; look <= looks; ++look) {
    const double time = static_cast<double>(look) * kLookEvery;
    const TrackedPose before = plain->sample(time);
    const TrackedPose after = changed->sample(time);
    if (!before.valid || time + lead > duration) continue;
    const Pose truth = motion(time + lead);
    ConditioningEffect::Part& part = rests(motion, time) ? effect.resting : effect.moving;
    part.time += kLookEvery;
    add_squares(before.X_WFt, truth, part.before);
    add_squares(after.X_WFt, truth, part.after);
  }
  conclude(effect.resting);
  conclude(effect.moving);
  return effect;
}

}  // namespace softfinger
