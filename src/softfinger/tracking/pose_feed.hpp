#pragma once

#include "softfinger/base/mailbox.hpp"
#include "softfinger/tracking/jump_gate.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// Passes the newest pose from a thread that receives poses to the loop that samples them; both
/// sides are wait-free. Tracking is lost when no valid pose was received for kLostAfter, by the
/// wall clock, and when the receiver says so; the last pose is held. Before the first there is
/// none. Glitches are left out, see JumpGate.
class PoseFeed {
 public:
  /// Receiving thread: a pose that was true at `captured` and arrived at `received`, both in s on
  /// the monotonic clock.
  void offer(const Pose& X_WFt, double captured, double received);
  /// Receiving thread: the body is not seen.
  void lose();
  /// Loop: the newest pose at run time `time` (s), which is `now` on the monotonic clock.
  [[nodiscard]] TrackedPose sample(double time, double now);

 private:
  struct Received {
    Pose X_WFt;
    double captured = 0.0;
    double received = 0.0;
    bool valid = false;
    bool known = false;
  };
  JumpGate gate_;    ///< receiving thread's
  Received newest_;  ///< receiving thread's
  Mailbox<Received> offered_;
  TrackedPose sampled_;  ///< the loop's
};

}  // namespace softfinger
