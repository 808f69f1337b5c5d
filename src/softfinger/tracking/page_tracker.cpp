#include "softfinger/tracking/page_tracker.hpp"

#include "softfinger/base/thread_clock.hpp"

namespace softfinger {

PageTracker::PageTracker(const Pose& start) { newest_.X_WFt = start; }

void PageTracker::offer(const Pose& X_WFt) {
  offered_.draft() = {X_WFt, monotonic_time()};
  offered_.publish();
}

TrackedPose PageTracker::sample(double time) {
  if (offered_.refresh()) {
    known_ = true;
    const Offer& offer = offered_.latest();
    newest_.X_WFt = offer.X_WFt;
    newest_.time = time;
    newest_.arrival = time - (monotonic_time() - offer.received);
  }
  newest_.valid = known_ && time - newest_.time <= kLostAfter;
  return newest_;
}

}  // namespace softfinger
