#include "softfinger/tracking/webxr_tracker.hpp"

#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {

WebXrTracker::WebXrTracker(const Pose& start, HandSide side, std::size_t joint)
    : side_(side), joint_(joint) {
  newest_.X_WFt = start;
}

void WebXrTracker::offer(const XrHand& hand) noexcept {
  if (hand.side != side_) return;
  Offer& draft = offered_.draft();
  draft.time = hand.time;
  draft.received = monotonic_time();
  draft.tracked = hand.tracked;
  if (hand.tracked) draft.X_WFt = bone_pose(hand, joint_);
  offered_.publish();
}

TrackedPose WebXrTracker::sample(double time) {
  const double now = monotonic_time();
  run_clock_.step(time, now);
  if (offered_.refresh()) {
    const Offer& offer = offered_.latest();
    // A headset that stands still and repeats itself is gone; after a silence it is another one,
    // whose clock may begin anywhere.
    const bool is_new = !known_ || offer.time > headset_time_ ||
                        (time - heard_ > kLostAfter && offer.time != headset_time_);
    if (is_new && (!offer.tracked || gate_.admits(offer.X_WFt, time))) {
      // A clock that went back is another one.
      if (!(offer.time > headset_time_)) headset_clock_.reset();
      known_ = true;
      heard_ = time;
      received_ = offer.received;
      headset_time_ = offer.time;
      tracked_ = offer.tracked;
      if (tracked_) {
        newest_.X_WFt = offer.X_WFt;
        newest_.time = run_clock_.run_time(headset_clock_.local_time(offer.time, offer.received));
        newest_.arrival = run_clock_.run_time(offer.received);
      }
    }
  }
  // What a link held back is the past, however fast it comes then.
  const bool is_late = time - newest_.time > kLostOnWallAfter;
  newest_.valid =
      tracked_ && !is_late && time - heard_ <= kLostAfter && now - received_ <= kLostOnWallAfter;
  return newest_;
}

}  // namespace softfinger
