#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/session/live_device.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/session/run_summary.hpp"
#include "softfinger/session/run_tracker.hpp"

namespace softfinger {

/// One finger of a run: where it is, its chain, and in a live run the thread of its device.
struct RunFinger {
  /// Opens the tracker. Throws InputError.
  RunFinger(const RunSetup& setup, std::size_t finger, const RunOptions& options, bool live);
  /// Opens the device, once every finger has its tracker. Throws InputError.
  void open(const RunSetup& setup, const RunOptions& options, bool is_live, ThreadTeam* team);

  /// After the last step, with the device's port closed: frees other ports for the next run, where
  /// a viewer keeps this one a little longer.
  void close();
  /// Null: no device.
  [[nodiscard]] Actuator* actuator() const;

  /// From the next tick on the device is led by this. One thread; nothing without a device.
  void lead_by(const ObjectiveKind& kind);

  std::size_t number;  ///< of the scene's fingers
  RunTracker tracker;
  std::unique_ptr<FingerChain> chain;           ///< null until open()
  std::unique_ptr<LiveDevice> live;             ///< null: headless, or no device
  std::chrono::steady_clock::time_point taken;  ///< when the last step took its pose
  TrackedPose tracked;                          ///< that pose
  /// Of a pause: since when its tracking is lost.
  std::optional<std::chrono::steady_clock::time_point> lost_in_pause;
  /// Asked for while it runs; null: what the run began with. Session's thread.
  const ObjectiveKind* led_by = nullptr;
  FingerSummary summary;  ///< simulation thread
};

}  // namespace softfinger
