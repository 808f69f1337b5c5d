#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/loop/scene_loop.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/session/event_sender.hpp"
#include "softfinger/session/run_finger.hpp"
#include "softfinger/session/run_messages.hpp"
#include "softfinger/session/run_objects.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/session/run_summary.hpp"
#include "softfinger/session/snapshot_publisher.hpp"
#include "softfinger/threads/ring_buffer.hpp"

namespace softfinger {

class ThreadTeam;

/// One run of one scene from start to end: the simulation thread and, in a live run, one device
/// thread a finger. Headless, a device tick is computed in the step it falls in; live, the step
/// hands its contact set to the device thread, newest value only.
class SceneRun {
 public:
  enum class Mode { kHeadless, kLive };
  struct Hooks {
    /// Called once on the simulation thread and on each device thread, after its first step or
    /// tick, and on each helper of the simulation before it helps; from then on the thread neither
    /// allocates nor locks. For scheduling, and for tests.
    std::function<void()> on_loop_thread;
    /// Headless: after each device tick, on the simulation thread, with the finger's number. May
    /// take its time; simulated time stands still.
    std::function<void(std::size_t finger, const FingerChain&)> on_tick;
    /// After each step, when its time is over as well, on the simulation thread. For measurements.
    std::function<void()> on_step;
  };

  /// Opens devices and trackers. Throws InputError, also where the recording exists already.
  /// `setup` as given by load_setup for these options; `generation` numbers the snapshots.
  SceneRun(std::shared_ptr<const RunSetup> setup, const RunOptions& options, Mode mode,
           std::uint64_t generation = 1, Hooks hooks = {});
  /// Ends as finish() does, without a word about failures.
  ~SceneRun();
  SceneRun(const SceneRun&) = delete;
  SceneRun& operator=(const SceneRun&) = delete;

  /// Creates the recording and lets the threads go. Throws InputError, OperationError.
  void start();
  /// Asks the loop to end after its present step. Any thread.
  void stop() noexcept { stopping_.store(true); }
  /// Live only. Simulated time stands still; the device keeps its pose.
  void set_paused(bool paused) noexcept { paused_.store(paused); }
  [[nodiscard]] bool paused() const noexcept { return paused_.load(); }
  /// Every device retracts at once, also in a pause, and stays so until it is released. Any thread.
  void stop_devices(StopCause cause) noexcept;
  /// Live only: this finger's device is led by that from its next tick on, which its record says.
  /// The thread that owns the run.
  void lead_by(std::size_t finger, const ObjectiveKind& kind);
  /// Paused, and stopped, where the run before it was: neither a restart nor another scene resumes,
  /// or releases; and led, where it is the same scene, by what was asked for. Before start().
  void continue_after(const SceneRun& before);
  /// Asks to release them. Says nothing, and does nothing, where devices were stopped again since
  /// stops() was `stops`. Any thread.
  bool ask_release(StopLatch::Number stops, StopCause by) noexcept;
  /// How often devices were stopped so far, by whomever.
  [[nodiscard]] StopLatch::Number stops() const noexcept;
  [[nodiscard]] DevicesStopped stopped() const noexcept;
  /// Live only: X_WFt of a finger whose tracker is the page; others are not moved. One thread.
  void offer_pose(std::size_t finger, const Pose& X_WFt) noexcept;
  /// Live only: a hand for every finger whose tracker is a headset. The same thread.
  void offer_hand(const XrHand& hand) noexcept;
  /// Live only: a person holds an object, see RunObjects. The same thread.
  void hold(std::size_t object, const Pose& X_WO) noexcept { wanted_.hold(object, X_WO); }
  void let_go(std::size_t object) noexcept { wanted_.let_go(object); }
  [[nodiscard]] const RunSetup& setup() const noexcept { return *setup_; }
  /// Whether the loop has come to its end.
  [[nodiscard]] bool ended() const noexcept { return ended_.load(); }
  /// End of the last finished step, s.
  [[nodiscard]] double time() const noexcept;
  /// When the run ends by itself, s; empty: never.
  [[nodiscard]] std::optional<double> duration() const;

  /// Ends the loop, retracts the devices, closes the recording. Blocks until the devices are
  /// retracted. Throws OperationError when the recording could not be written. Once.
  RunSummary finish();

  /// Live only; one reader thread.
  [[nodiscard]] Mailbox<Snapshot>& snapshots() { return snapshots_->snapshots(); }
  /// Live only; each once. One reader thread; of more than 256 that wait the newest are left out.
  [[nodiscard]] std::optional<EventRecord> take_event();
  /// See RunMessages. One thread.
  [[nodiscard]] std::optional<std::string> take_message();

 private:
  void open_recording();
  void simulate();
  void simulate_step(std::int64_t step);
  std::span<const FollowRecord> wanted_objects(std::int64_t step);
  void record_objects();
  void tell_events();
  void conclude_step(RunFinger& finger, std::int64_t step);
  void tick_here(RunFinger& finger, const TickInput& input);
  void obey_signals() noexcept;
  void keep_devices_alive(std::int64_t step);
  void publish_snapshot(std::int64_t step, bool finished);
  void end_threads();
  void retract_devices();

  std::shared_ptr<const RunSetup> setup_;
  Mode mode_;
  bool paced_;
  double rate_;
  Hooks hooks_;
  std::optional<std::int64_t> total_steps_;
  std::unique_ptr<ThreadTeam> team_;  ///< null: one thread
  std::vector<std::unique_ptr<RunFinger>> fingers_;
  std::optional<SceneLoop> scene_;  ///< of their chains
  RunObjects wanted_;
  std::vector<TrackedInput> tracked_;     ///< by finger, of the step under way
  std::filesystem::path recording_file_;  ///< empty: none
  bool record_state_ = false;
  std::unique_ptr<RecordingWriter> recording_;
  std::unique_ptr<EventSender> events_sent_;  ///< null: to nobody
  RingBuffer<EventRecord> events_told_{256};  ///< to the viewer
  std::unique_ptr<SnapshotPublisher> snapshots_;
  RunMessages messages_;
  std::int64_t snapshot_interval_;  ///< steps

  std::thread thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> paused_{false};
  StopLatch no_device_;         ///< what a scene without devices has to stop
  const StopSignals* signals_;  ///< see RunOptions; null: none
  std::atomic<std::uint32_t> stop_signals_seen_{0};
  std::atomic<std::uint32_t> release_signals_seen_{0};
  std::atomic<bool> ended_{false};
  std::atomic<std::int64_t> step_{0};
  std::atomic<std::uint64_t> deadline_misses_{0};
};

}  // namespace softfinger
