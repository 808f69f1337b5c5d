#pragma once

#include <functional>
#include <memory>
#include <thread>

#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/loop/tick_handover.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/session/live_twin.hpp"
#include "softfinger/session/run_summary.hpp"
#include "softfinger/session/scene_snapshot.hpp"
#include "softfinger/threads/mailbox.hpp"

namespace softfinger {

/// One finger's device in a live run: a thread that ticks whenever a step is handed over to it, and
/// what it tells the simulation of each tick.
class LiveDevice {
 public:
  /// `chain` has a device and outlives this. `twin`: pressed by every command, for the page; null:
  /// none.
  LiveDevice(FingerChain& chain, const FingerModel& model, std::unique_ptr<LiveTwin> twin);
  /// Ends the threads.
  ~LiveDevice();
  LiveDevice(const LiveDevice&) = delete;
  LiveDevice& operator=(const LiveDevice&) = delete;

  /// Lets the threads go. Ticks are recorded where there is a recording; `on_loop_thread` is called
  /// by the device's after its first tick.
  void start(RecordingWriter* recording, const std::function<void()>& on_loop_thread);
  /// No tick begins any more.
  void stop() { handover_.end(); }
  /// After stop(): waits for what is under way.
  void join();

  // Simulation thread; wait-free.
  /// The last step, as `input` tells of it.
  void hand_over(const TickInput& input);
  /// The step where time stands, once more, where a tick's time has passed since the last. Without
  /// fresh commands a device takes the loop for stalled and retracts. These are ticks like all
  /// others, so that a replay takes them too.
  void hand_over_again();
  /// Tells the chain of the newest tick, if there is one not yet told.
  void take_feedback();
  [[nodiscard]] const DeviceFeedback& feedback() const { return feedback_.latest(); }
  /// Null: none.
  [[nodiscard]] LiveTwin* twin() { return twin_.get(); }

  /// After join().
  [[nodiscard]] const FingerSummary& summary() const { return summary_; }

 private:
  void serve(RecordingWriter* recording, const std::function<void()>& on_loop_thread);

  FingerChain& chain_;
  TickHandover handover_;
  Mailbox<DeviceFeedback> feedback_;
  std::unique_ptr<LiveTwin> twin_;
  FingerSummary summary_;  ///< device thread
  std::thread thread_;
};

}  // namespace softfinger
