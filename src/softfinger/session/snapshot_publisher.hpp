#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "softfinger/loop/scene_loop.hpp"
#include "softfinger/session/live_feed.hpp"
#include "softfinger/session/run_finger.hpp"
#include "softfinger/threads/mailbox.hpp"

namespace softfinger {

/// Snapshots of a live run, as the page draws them.
class SnapshotPublisher {
 public:
  /// State of the run beside that of its fingers.
  struct Moment {
    std::int64_t step = 0;
    double time = 0.0;  ///< s
    bool paused = false;
    StopLatch::Number stops = 0;
    DevicesStopped stopped;
    bool finished = false;
    std::uint64_t deadline_misses = 0;
  };
  using Fingers = std::vector<std::unique_ptr<RunFinger>>;

  /// Before the first step. `generation` numbers the snapshots.
  SnapshotPublisher(std::shared_ptr<const RunSetup> setup, std::uint64_t generation,
                    const Fingers& fingers);

  /// Simulation thread; wait-free, allocates nothing.
  void publish(const Moment& moment, const SceneLoop& scene, const Fingers& fingers);
  /// For one reader thread.
  [[nodiscard]] Mailbox<Snapshot>& snapshots() { return snapshots_; }

 private:
  std::shared_ptr<const RunSetup> setup_;
  Mailbox<Snapshot> snapshots_;
};

}  // namespace softfinger
