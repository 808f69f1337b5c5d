#include "softfinger/tracking/page_tracker.hpp"

namespace softfinger {

PageTracker::PageTracker(const Pose& start) { newest_.X_WFt = start; }

void PageTracker::offer(const Pose& X_WFt) {
  offered_.draft() = X_WFt;
  offered_.publish();
}

TrackedPose PageTracker::sample(double time) {
  if (offered_.refresh()) {
    known_ = true;
    newest_.X_WFt = offered_.latest();
    newest_.time = time;
  }
  newest_.valid = known_ && time - newest_.time <= kLostAfter;
  return newest_;
}

}  // namespace softfinger
