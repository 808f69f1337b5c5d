#pragma once

#include <memory>
#include <optional>
#include <string>

#include "softfinger/session/run_setup.hpp"
#include "softfinger/tracking/tracker.hpp"
#include "softfinger/tracking/xr_hand.hpp"

namespace softfinger {

class PageTracker;
class WebXrTracker;

/// Where one finger of a run is: its tracker, registered and conditioned, and what a person at the
/// page tells it.
class RunTracker {
 public:
  /// `live`: there is a page. Throws InputError for a tracker that this run cannot have, and what
  /// make_tracker() throws.
  RunTracker(const RunSetup& setup, std::size_t finger, const RunOptions& options, bool live);
  ~RunTracker();

  /// Simulation thread; `time` in s.
  [[nodiscard]] TrackedPose sample(double time) { return tracker_->sample(time); }
  /// When the run should end, s; empty: never.
  [[nodiscard]] std::optional<double> end_time() const { return tracker_->end_time(); }
  /// What is made of its poses, see conditioning_text().
  [[nodiscard]] const std::string& conditioning() const { return conditioning_; }
  /// See Tracker.
  [[nodiscard]] std::optional<std::string> take_message();

  /// Where the page moves this finger: X_WFt; another is not moved. One thread.
  void offer(const Pose& X_WFt) noexcept;
  /// Where a headset does. The same thread.
  void offer(const XrHand& hand) noexcept;

  /// After the last sample(): frees its port. What the page moves it may still offer poses to.
  void close();

 private:
  std::unique_ptr<Tracker> tracker_;  ///< null: closed
  std::string conditioning_;
  PageTracker* page_tracker_ = nullptr;    ///< the same, where the page moves the finger
  WebXrTracker* webxr_tracker_ = nullptr;  ///< the same, where a headset does
};

}  // namespace softfinger
