#pragma once

#include "softfinger/threads/mailbox.hpp"
#include "softfinger/tracking/run_clock.hpp"
#include "softfinger/tracking/stream/jump_gate.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// Passes the newest pose from a thread that receives poses to the loop that samples them; both
/// sides are wait-free. Tracking is lost when no valid pose was received for kLostAfter, by the
/// wall clock, and when the receiver says so; the last pose is held. Before the first there is
/// none, only where the finger is to be drawn. Glitches are left out, see JumpGate.
class PoseFeed {
 public:
  /// `start`: X_WFt until a pose was offered.
  explicit PoseFeed(const Pose& start = {}) { sampled_.X_WFt = start; }
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
  RunClock clock_;       ///< the loop's
  TrackedPose sampled_;  ///< the loop's
};

}  // namespace softfinger
