#pragma once

#include "softfinger/threads/mailbox.hpp"
#include "softfinger/tracking/run_clock.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// A finger that a person moves on the live page, with the mouse and keys. The page keeps offering
/// poses, moved or not; where none comes for kLostAfter of the run's time (nobody looks, the page
/// is gone), tracking is lost, with the last pose held. Before the first it is nowhere but at its
/// start.
class PageTracker final : public Tracker {
 public:
  /// `start`: X_WFt until the page offers one.
  explicit PageTracker(const Pose& start);
  /// X_WFt, finite and rigid; any one thread. Wait-free.
  void offer(const Pose& X_WFt);
  /// It is moved no longer: tracking is lost at once. The same thread. Wait-free.
  void let_go();

  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }

 private:
  struct Offer {
    Pose X_WFt;
    double received = 0.0;  // s, monotonic clock
    bool let_go = false;
  };

  Mailbox<Offer> offered_;
  RunClock clock_;
  double heard_ = 0.0;  // s, of the run, when a pose came
  TrackedPose newest_;
  bool known_ = false;
};

}  // namespace softfinger
