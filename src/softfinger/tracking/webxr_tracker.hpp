#pragma once

#include "softfinger/threads/mailbox.hpp"
#include "softfinger/tracking/run_clock.hpp"
#include "softfinger/tracking/stream/jump_gate.hpp"
#include "softfinger/tracking/tracker.hpp"
#include "softfinger/tracking/xr_hand.hpp"

namespace softfinger {

/// A finger, or another bone, of a hand that a headset tracks, as its page tells frame by frame.
/// Tracking is lost when the headset says so, says nothing new for kLostAfter of the run's time, or
/// what it says is older than kLostOnWallAfter by its own clock (by a second or more: its clock was
/// set, and nobody knows); the last pose is then held. Before the first it is nowhere but at its
/// start. Glitches are left out, see JumpGate.
class WebXrTracker final : public Tracker {
 public:
  /// `start`: X_WFt until the headset has seen the hand.
  WebXrTracker(const Pose& start, HandSide side, HandFinger finger)
      : WebXrTracker(start, side, distal_joint(finger)) {}
  /// The bone that begins at this joint, see bone_pose().
  WebXrTracker(const Pose& start, HandSide side, std::size_t joint);
  /// A hand of the other side changes nothing. Any one thread; wait-free.
  void offer(const XrHand& hand) noexcept;

  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }

 private:
  struct Offer {
    Pose X_WFt;
    double time = 0.0;      // s, the headset's
    double received = 0.0;  // s, monotonic clock
    bool tracked = false;
  };

  HandSide side_;
  std::size_t joint_;
  Mailbox<Offer> offered_;
  JumpGate gate_;
  SenderClock headset_clock_;
  RunClock run_clock_;
  TrackedPose newest_;
  double heard_ = 0.0;         // s, of the run, when something new came
  double received_ = 0.0;      // s, monotonic clock, the same
  double headset_time_ = 0.0;  // s, of what came then
  bool known_ = false;
  bool tracked_ = false;
};

}  // namespace softfinger
