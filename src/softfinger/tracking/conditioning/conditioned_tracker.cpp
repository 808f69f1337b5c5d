#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/tracking/conditioning/interpolated_tracker.hpp"

namespace softfinger {
namespace {

/// Time constant (s) in which velocity for prediction is averaged: differences of single poses
/// would carry their noise ahead.
constexpr double kVelocityTime = 0.02;

}  // namespace

ConditionedTracker::ConditionedTracker(std::unique_ptr<Tracker> source,
                                       const PoseConditioning& conditioning)
    : source_(std::move(source)),
      conditioning_(conditioning),
      filter_(conditioning.filter.value_or(OneEuroSettings{})) {}

void ConditionedTracker::take(const TrackedPose& pose) {
  const double dt = pose.time - newest_.time;
  // After a gap there is nothing to be smooth with.
  if (!newest_.valid || !(dt > 0.0) || dt > kLostAfter) {
    X_WFt_ = pose.X_WFt;
    filter_.reset(pose.X_WFt);
    velocity_W_.setZero();
    turn_rate_Ft_.setZero();
  } else {
    const Pose before = X_WFt_;
    X_WFt_ = conditioning_.filter ? filter_.update(pose.X_WFt, dt) : pose.X_WFt;
    const double share = -std::expm1(-dt / kVelocityTime);
    velocity_W_ += share * ((X_WFt_.translation - before.translation) / dt - velocity_W_);
    turn_rate_Ft_ +=
        share * (log_rotation(before.rotation.transpose() * X_WFt_.rotation) / dt - turn_rate_Ft_);
  }
  newest_ = pose;
}

Pose ConditionedTracker::predicted(double ahead) const {
  return {X_WFt_.rotation * exp_rotation(ahead * turn_rate_Ft_),
          X_WFt_.translation + ahead * velocity_W_};
}

TrackedPose ConditionedTracker::sample(double time) {
  TrackedPose pose = source_->sample(time);
  if (!pose.valid) {
    newest_.valid = false;
    return pose;
  }
  if (!newest_.valid || pose.time != newest_.time) take(pose);
  pose.X_WFt = X_WFt_;
  if (conditioning_.lead) {
    const double ahead = std::max(0.0, time - pose.time) + *conditioning_.lead;
    pose.X_WFt = predicted(std::min(ahead, PoseConditioning::kFarthest));
  }
  return pose;
}

std::unique_ptr<Tracker> conditioned(std::unique_ptr<Tracker> source,
                                     const PoseConditioning& conditioning, bool sent) {
  if (conditioning.changes_poses()) {
    source = std::make_unique<ConditionedTracker>(std::move(source), conditioning);
  }
  if (sent && !conditioning.lead) source = std::make_unique<InterpolatedTracker>(std::move(source));
  return source;
}

std::string conditioning_text(const PoseConditioning& conditioning, bool sent) {
  std::string text = conditioning.filter ? "filtered" : "";
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
  if (conditioning.lead) {
    add(fmt::format("carried on by {} ms", *conditioning.lead / ms));
  } else if (sent) {
    add("interpolated");
  }
  return text;
}

}  // namespace softfinger
