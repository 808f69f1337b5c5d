#include "softfinger/tracking/stream/pose_feed.hpp"

#include <algorithm>

namespace softfinger {

void PoseFeed::offer(const Pose& X_WFt, double captured, double received) {
  if (!gate_.admits(X_WFt, received)) return;
  newest_ = {X_WFt, std::min(captured, received), received, true, true};
  offered_.draft() = newest_;
  offered_.publish();
}

void PoseFeed::lose() {
  newest_.valid = false;
  offered_.draft() = newest_;
  offered_.publish();
}

TrackedPose PoseFeed::sample(double time, double now) {
  clock_.step(time, now);
  const bool fresh = offered_.refresh();
  const Received& newest = offered_.latest();
  if (fresh && newest.known) {
    sampled_.X_WFt = newest.X_WFt;
    sampled_.time = clock_.run_time(newest.captured);
    sampled_.arrival = clock_.run_time(newest.received);
  }
  sampled_.valid = newest.valid && now - newest.received <= kLostAfter;
  return sampled_;
}

}  // namespace softfinger
