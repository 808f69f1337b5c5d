#include "circle_tracker.hpp"

#include <cmath>
#include <numbers>

#include "softfinger/base/error.hpp"

namespace softfinger {

CircleTracker::CircleTracker(const Vector3& centre_W, double radius, double period, double turns)
    : centre_W_(centre_W), radius_(radius), period_(period), turns_(turns) {
  if (!(radius >= 0.0 && period > 0.0 && turns > 0.0)) {
    throw InputError("tracker circle: radius, period and turns must be positive");
  }
}

TrackedPose CircleTracker::sample(double time) {
  const double angle = 2.0 * std::numbers::pi * time / period_;
  TrackedPose tracked;
  tracked.time = time;
  tracked.X_WFt.translation = centre_W_ + radius_ * Vector3(std::cos(angle), std::sin(angle), 0.0);
  tracked.valid = true;
  return tracked;
}

}  // namespace softfinger
