#include "softfinger/tracking/conditioning/one_euro_filter.hpp"

#include <numbers>

namespace softfinger {
namespace {

/// How much of a new value a first-order low-pass takes over in dt.
double share(double cutoff, double dt) {
  return 1.0 / (1.0 + 1.0 / (2.0 * std::numbers::pi * cutoff * dt));
}

}  // namespace

void OneEuroFilter::reset(const Pose& pose) {
  last_ = smoothed_ = pose;
  velocity_.setZero();
  turn_rate_.setZero();
}

const Pose& OneEuroFilter::update(const Pose& pose, double dt) {
  const double of_speed = share(settings_.speed_cutoff, dt);
  velocity_ += of_speed * ((pose.translation - last_.translation) / dt - velocity_);
  turn_rate_ +=
      of_speed * (log_rotation(last_.rotation.transpose() * pose.rotation) / dt - turn_rate_);
  last_ = pose;

  const double of_position =
      share(settings_.min_cutoff + settings_.per_speed * velocity_.norm(), dt);
  const double of_rotation =
      share(settings_.min_cutoff + settings_.per_turn_rate * turn_rate_.norm(), dt);
  smoothed_.translation += of_position * (pose.translation - smoothed_.translation);
  const Vector3 turn = log_rotation(smoothed_.rotation.transpose() * pose.rotation);
  smoothed_.rotation = smoothed_.rotation * exp_rotation(of_rotation * turn);
  return smoothed_;
}

}  // namespace softfinger
