#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>

#include "softfinger/session/device_fit.hpp"
#include "softfinger/session/live_feed.hpp"
#include "softfinger/session/run_setup.hpp"

namespace softfinger {

/// A fit of a device to its wearer that the page asked for: takes the place of a run, which has
/// ended by then, and writes the person's file.
class LiveFit {
 public:
  /// Says that it is to come, once the run of `options` has ended. The session's thread, as run().
  void await(const LiveRequest& request, const RunOptions& options);
  /// Presses until all is done, or `stop`, cancel() or a stop end it, also one that came since it
  /// was awaited; the device is retracted then. `setup` and `options` are those of the run before.
  /// True: the person's file was written.
  bool run(const RunSetup& setup, const RunOptions& options, const std::atomic<bool>& stop,
           const RunObserver& observer);

  /// Any thread, as those below: ends it where it is under way, else forgets what is told of it.
  void cancel();
  /// The wearer feels the device, of a fit by touches.
  void tell_touch() { told_.store(true); }
  /// A person stops the device.
  void stop_device();
  [[nodiscard]] FitState state() const;

 private:
  /// Whether a signal has stopped devices since the last look.
  bool stopped_by_signal(const RunOptions& options);
  void watch(const DeviceFitMoment& now);
  void conclude(const DeviceFit& found);

  LiveRequest wanted_;
  StopSignals stops_;
  std::uint32_t signals_seen_ = 0;
  std::atomic<bool> ending_{false}, told_{false};
  mutable std::mutex mutex_;  ///< of what follows
  FitState state_;
};

}  // namespace softfinger
