#include "softfinger/tracking/page_tracker.hpp"

#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {

PageTracker::PageTracker(const Pose& start) { newest_.X_WFt = start; }

void PageTracker::offer(const Pose& X_WFt) {
  offered_.draft() = {X_WFt, monotonic_time()};
  offered_.publish();
}

void PageTracker::let_go() {
  offered_.draft() = {Pose(), monotonic_time(), true};
  offered_.publish();
}

TrackedPose PageTracker::sample(double time) {
  const double now = monotonic_time();
  clock_.step(time, now);
  if (offered_.refresh()) {
    const Offer& offer = offered_.latest();
    known_ = !offer.let_go;
    if (known_) newest_.X_WFt = offer.X_WFt;
    heard_ = time;
    newest_.arrival = clock_.run_time(offer.received);
    newest_.time = newest_.arrival;
  }
  newest_.valid =
      known_ && time - heard_ <= kLostAfter && now - offered_.latest().received <= kLostOnWallAfter;
  return newest_;
}

}  // namespace softfinger
