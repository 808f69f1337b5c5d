#include "softfinger/session/scene_run.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/loop/device_clock.hpp"
#include "softfinger/loop/device_loop.hpp"
#include "softfinger/loop/finger_loop.hpp"
#include "softfinger/loop/step_pacer.hpp"
#include "softfinger/session/live_twin.hpp"
#include "softfinger/session/scene_snapshot.hpp"
#include "softfinger/threads/awake_processors.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/threads/thread_priority.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/tracking/conditioned_tracker.hpp"
#include "softfinger/tracking/make_tracker.hpp"
#include "softfinger/tracking/page_tracker.hpp"
#include "softfinger/tracking/registered_tracker.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "softfinger/tracking/webxr_tracker.hpp"

namespace softfinger {
/// What a step hands to the device thread.
struct HandedTick {
  TickInput input;
  ContactSet contact;
  std::vector<Vector3> nodes_W;  ///< empty: not wanted
  Pose X_WF;

  [[nodiscard]] VirtualFinger finger() const { return {contact, nodes_W, X_WF}; }
};

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSnapshotRate = 60.0;  // Hz
constexpr auto kPausedInterval = std::chrono::milliseconds(5);

/// A mailbox draft has to have its full size before the loop starts.
HandedTick initial_handed(const FingerModel& model, bool with_nodes) {
  HandedTick handed;
  handed.contact.samples.resize(model.sample_nodes.size());
  if (with_nodes) handed.nodes_W.resize(model.mesh.nodes.size());
  return handed;
}

VirtualFinger virtual_finger(const FingerLoop& loop) {
  const FingerSimulation& simulation = loop.simulation();
  return {loop.contact(), simulation.positions(), simulation.bone_pose()};
}

}  // namespace

struct SceneRun::Finger {
  Finger(std::int64_t index, const RunSetup& setup, const RunOptions& options, Mode mode,
         ThreadTeam* team)
      : loop(index, setup.models[static_cast<std::size_t>(index)], setup.scene.objects,
             setup.scene.simulation_rate, options.record_state && options.recording, team),
        clock(setup.scene.simulation_rate, 1.0) {
    const auto i = static_cast<std::size_t>(index);
    const SceneFinger& scene_finger = setup.scene.fingers[i];
    if (mode == Mode::kHeadless && options.as_fast_as_possible &&
        is_network_tracker(parse_tracker_spec(scene_finger.tracker).kind)) {
      throw InputError(
          fmt::format("finger {}: tracker {} sends as time passes, and a run as fast as possible "
                      "does not wait for it; use script or csv:FILE",
                      scene_finger.name, scene_finger.tracker));
    }
    tracker =
        make_tracker(scene_finger.tracker, setup.tracker_directories[i], scene_finger.waypoints);
    page_tracker = dynamic_cast<PageTracker*>(tracker.get());
    webxr_tracker = dynamic_cast<WebXrTracker*>(tracker.get());
    if ((page_tracker != nullptr || webxr_tracker != nullptr) && mode == Mode::kHeadless) {
      throw InputError(
          fmt::format("finger {}: tracker {} is a person at the live page; a headless run has none",
                      scene_finger.name, scene_finger.tracker));
    }
    if (const auto& X_BodyFt = setup.registrations[i]) {
      tracker = std::make_unique<RegisteredTracker>(std::move(tracker), *X_BodyFt);
    }
    const bool sent = page_tracker != nullptr || webxr_tracker != nullptr ||
                      is_network_tracker(parse_tracker_spec(scene_finger.tracker).kind);
    tracker = conditioned(std::move(tracker), options.conditioning, sent);
    if (!setup.devices[i]) return;
    clock = DeviceClock(setup.scene.simulation_rate, device_rate(*setup.devices[i]));
    DeviceLoopOptions device_options;
    device_options.objective = options.objective;
    device_options.wearer = setup.wearer;
    ActuatorOptions& actuator = device_options.actuator;
    if (scene_finger.device) actuator.device_file = *scene_finger.device;
    actuator.wait_for_device = options.wait_for_device;
    actuator.port = options.port;
    actuator.guard_program = options.guard_program;
    actuator.simulated_time = mode == Mode::kHeadless && options.as_fast_as_possible;
    actuator.ceiling = setup.ceilings[i];
    device = std::make_unique<DeviceLoop>(index, setup.devices[i], setup.models[i], device_options);
    feedback.emplace(initial_feedback(*device));
    input.emplace(initial_handed(*setup.models[i], device->wants_nodes()));
    if (mode == Mode::kLive && options.twin && index == 0) {
      twin = std::make_unique<LiveTwin>(setup.wearer ? setup.wearer : setup.models[i],
                                        setup.devices[i]);
    }
  }

  FingerLoop loop;
  DeviceClock clock;
  std::unique_ptr<Tracker> tracker;
  PageTracker* page_tracker = nullptr;    // the same, where the page moves the finger
  WebXrTracker* webxr_tracker = nullptr;  // the same, where a headset does
  std::unique_ptr<DeviceLoop> device;     // null: none
  std::unique_ptr<LiveTwin> twin;         // null: none
  std::int64_t known_tick = -1;           // newest tick known to the simulation
  std::uint64_t known_tick_hash = 0;
  double known_match_time = 0.0;
  TickInput last_sent{};
  Clock::time_point taken;  // the step's pose
  TrackedPose tracked;
  FingerSummary summary;  // simulation thread

  // Live: between the simulation thread and this finger's device thread.
  std::optional<Mailbox<HandedTick>> input;
  std::optional<Mailbox<DeviceFeedback>> feedback;
  std::atomic<std::uint32_t> doorbell{0};
  std::thread thread;
  FingerSummary device_summary;  // device thread
};

SceneRun::SceneRun(std::shared_ptr<const RunSetup> setup, const RunOptions& options, Mode mode,
                   std::uint64_t generation, Hooks hooks)
    : setup_(std::move(setup)),
      mode_(mode),
      paced_(mode == Mode::kLive || !options.as_fast_as_possible),
      rate_(setup_->scene.simulation_rate),
      hooks_(std::move(hooks)),
      generation_(generation),
      snapshot_interval_(
          std::max<std::int64_t>(1, static_cast<std::int64_t>(rate_ / kSnapshotRate))),
      emergency_stop_(options.emergency_stop) {
  if (options.threads > 1) {
    team_ = std::make_unique<ThreadTeam>(options.threads, [this] {
      std::optional<AwakeProcessors> awake;
      if (paced_) {
        prefer_this_thread(LoopThread::kSimulation);
        awake.emplace();
      }
      if (hooks_.on_loop_thread) hooks_.on_loop_thread();
    });
  }
  const std::size_t count = setup_->scene.fingers.size();
  for (std::size_t i = 0; i < count; ++i) {
    fingers_.push_back(std::make_unique<Finger>(static_cast<std::int64_t>(i), *setup_, options,
                                                mode, count == 1 ? team_.get() : nullptr));
  }
  std::optional<double> end = options.duration;
  if (!end) {
    end = 0.0;
    for (const auto& finger : fingers_) {
      const std::optional<double> one = finger->tracker->end_time();
      end = end && one ? std::optional(std::max(*end, *one)) : std::nullopt;
    }
  }
  // A duration that is a whole number of steps up to rounding is that number.
  if (end) total_steps_ = static_cast<std::int64_t>(std::ceil(*end * rate_ - 1e-6));

  Snapshot snapshot = initial_snapshot(*setup_);
  snapshot.generation = generation_;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    if (fingers_[i]->device) fill(snapshot.fingers[i], fingers_[i]->feedback->latest());
    if (fingers_[i]->twin) snapshot.fingers[i].twin = fingers_[i]->twin->latest();
  }
  snapshots_.emplace(snapshot);

  // Created by start(), so that nothing is left behind where another part of the program refuses.
  if (options.recording) {
    if (std::filesystem::exists(*options.recording)) refuse_existing_recording(*options.recording);
    recording_file_ = *options.recording;
    record_state_ = options.record_state;
  }
}

SceneRun::~SceneRun() {
  end_threads();
  retract_devices();
}

void SceneRun::open_recording() {
  StepRecord largest;
  for (const auto& finger : fingers_) {
    const StepRecord& record = finger->loop.record();
    if (record.nodes_W.size() > largest.nodes_W.size()) largest.nodes_W = record.nodes_W;
    if (record.samples.size() > largest.samples.size()) largest.samples = record.samples;
  }
  RecordingInfo info = recording_info(*setup_);
  info.live = mode_ == Mode::kLive;
  info.with_state = record_state_;
  recording_ = std::make_unique<RecordingWriter>(
      recording_file_, info,
      mode_ == Mode::kLive ? RecordingWriter::WhenFull::kDrop : RecordingWriter::WhenFull::kWait,
      largest);
}

void SceneRun::start() {
  if (!recording_file_.empty()) open_recording();
  for (const auto& finger : fingers_) {
    if (finger->device && mode_ == Mode::kLive) {
      finger->thread = std::thread([this, &served = *finger] { serve_device(served); });
      if (finger->twin) finger->twin->start();
    }
  }
  thread_ = std::thread([this] { simulate(); });
}

double SceneRun::time() const noexcept { return static_cast<double>(step_.load()) / rate_; }

std::optional<double> SceneRun::duration() const {
  if (!total_steps_) return std::nullopt;
  return static_cast<double>(*total_steps_) / rate_;
}

void SceneRun::offer_pose(std::size_t finger, const Pose& X_WFt) noexcept {
  if (finger >= fingers_.size() || fingers_[finger]->page_tracker == nullptr) return;
  fingers_[finger]->page_tracker->offer(X_WFt);
}

void SceneRun::offer_hand(const XrHand& hand) noexcept {
  for (const auto& finger : fingers_) {
    if (finger->webxr_tracker != nullptr) finger->webxr_tracker->offer(hand);
  }
}

bool SceneRun::emergency() const noexcept {
  return emergency_.load(std::memory_order_relaxed) ||
         (emergency_stop_ != nullptr && emergency_stop_->load(std::memory_order_relaxed));
}

void SceneRun::simulate() {
  std::optional<AwakeProcessors> awake;
  if (paced_) {
    prefer_this_thread(LoopThread::kSimulation);
    awake.emplace();
  }
  for (const auto& finger : fingers_) {
    finger->loop.start(TrackedInput(finger->tracker->sample(0.0)));
    const StepRecord& record = finger->loop.seal(-1, 0);
    if (recording_) recording_->push(record);
  }
  StepPacer pacer(rate_);
  std::int64_t step = 0;
  while (!stopping_.load(std::memory_order_relaxed) && !(total_steps_ && step >= *total_steps_)) {
    if (paused_.load(std::memory_order_relaxed) && mode_ == Mode::kLive) {
      keep_devices_alive();
      publish_snapshot(step, false);
      std::this_thread::sleep_for(kPausedInterval);
      pacer.restart(step + 1);
      continue;
    }
    ++step;
    simulate_step(step);
    step_.store(step, std::memory_order_relaxed);
    if (mode_ == Mode::kLive && step % snapshot_interval_ == 0) publish_snapshot(step, false);
    if (paced_) {
      pacer.wait(step);
      deadline_misses_.store(pacer.misses(), std::memory_order_relaxed);
    }
    if (hooks_.on_step) hooks_.on_step();
    if (step == 1 && hooks_.on_loop_thread) hooks_.on_loop_thread();
  }
  // A run that is stopped before its end, for another scene, has not finished its script.
  if (mode_ == Mode::kLive) publish_snapshot(step, total_steps_ && step >= *total_steps_);
  ended_.store(true);
}

void SceneRun::simulate_step(std::int64_t step) {
  const bool side_by_side = team_ && fingers_.size() > 1;
  if (side_by_side) {
    team_->run(fingers_.size(), [&](std::size_t i, int) { step_finger(*fingers_[i], step); });
  }
  for (const auto& finger : fingers_) {
    if (!side_by_side) step_finger(*finger, step);
    conclude_step(*finger, step);
  }
}

void SceneRun::step_finger(Finger& finger, std::int64_t step) {
  finger.taken = Clock::now();
  finger.tracked = finger.tracker->sample(static_cast<double>(step) / rate_);
  finger.loop.step(step, TrackedInput(finger.tracked));
}

void SceneRun::conclude_step(Finger& finger, std::int64_t step) {
  const double time = static_cast<double>(step) / rate_;
  if (finger.device) {
    const bool due = finger.clock.ticks(step);
    TickInput input{.step = step,
                    .time = time,
                    .tracked = finger.tracked.valid,
                    .emergency = emergency(),
                    .taken = finger.taken,
                    .handed = Clock::now()};
    note_way_here(finger.tracked, time, input);
    if (mode_ == Mode::kHeadless) {
      if (due) tick_here(finger, input);
    } else {
      if (due) send_to_device(finger, input);
      if (finger.feedback->refresh()) {
        const TickRecord& tick = finger.feedback->latest().tick;
        finger.known_tick = tick.tick;
        finger.known_tick_hash = tick.hash;
        finger.known_match_time = tick.cpu_time;
      }
    }
  }
  const StepRecord& record = finger.loop.seal(finger.known_tick, finger.known_tick_hash);
  if (recording_) recording_->push(record);
  finger.summary.add(record);
}

void SceneRun::tick_here(Finger& finger, const TickInput& input) {
  const TickRecord& tick = finger.device->tick(input, virtual_finger(finger.loop));
  finger.known_tick = tick.tick;
  finger.known_tick_hash = tick.hash;
  if (recording_) recording_->push(tick);
  finger.device_summary.add(tick);
  if (hooks_.on_tick) {
    hooks_.on_tick(static_cast<std::size_t>(tick.finger), finger.loop, *finger.device);
  }
}

void SceneRun::send_to_device(Finger& finger, const TickInput& input) {
  finger.last_sent = input;
  HandedTick& draft = finger.input->draft();
  draft.input = input;
  draft.contact = finger.loop.contact();
  if (finger.device->wants_nodes()) {
    const std::span<const Vector3> nodes = finger.loop.simulation().positions();
    std::copy(nodes.begin(), nodes.end(), draft.nodes_W.begin());
    draft.X_WF = finger.loop.simulation().bone_pose();
  }
  finger.input->publish();
  finger.doorbell.fetch_add(1, std::memory_order_release);
  finger.doorbell.notify_one();
}

// Without fresh commands a device takes the loop for stalled and retracts. These are ticks like all
// others, of the step where time stands, so that a replay takes them too.
void SceneRun::keep_devices_alive() {
  if (emergency()) return;  // and then it retracts
  for (const auto& finger : fingers_) {
    if (!finger->device || finger->last_sent.step == 0) continue;
    const auto period = std::chrono::duration<double>(1.0 / device_rate(finger->device->device()));
    const Clock::time_point now = Clock::now();
    if (now - finger->last_sent.handed < period) continue;
    send_to_device(*finger, {.step = finger->loop.record().step,
                             .time = finger->loop.record().time,
                             .tracked = finger->last_sent.tracked,
                             .taken = now,
                             .handed = now});
  }
}

void SceneRun::serve_device(Finger& finger) {
  prefer_this_thread(LoopThread::kDevice);
  std::uint32_t heard = 0;
  bool first = true;
  while (true) {
    finger.doorbell.wait(heard, std::memory_order_acquire);
    heard = finger.doorbell.load(std::memory_order_acquire);
    if (devices_ending_.load()) return;
    if (!finger.input->refresh()) continue;
    const HandedTick& handed = finger.input->latest();
    const TickRecord& tick = finger.device->tick(handed.input, handed.finger());
    // Recorded before it is told: a recorded step never names a tick that is not recorded.
    if (recording_) recording_->push(tick);
    finger.device_summary.add(tick);
    read_device(*finger.device, finger.feedback->draft());
    finger.feedback->publish();
    if (finger.twin) finger.twin->offer(tick, finger.input->latest().contact);
    if (first && hooks_.on_loop_thread) hooks_.on_loop_thread();
    first = false;
  }
}

void SceneRun::publish_snapshot(std::int64_t step, bool finished) {
  Snapshot& draft = snapshots_->draft();
  draft.generation = generation_;
  draft.step = static_cast<std::uint64_t>(step);
  draft.time = static_cast<double>(step) / rate_;
  draft.wall_time = monotonic_time();
  draft.paused = paused_.load(std::memory_order_relaxed);
  draft.emergency = emergency();
  draft.finished = finished;
  draft.step_cpu_time = 0.0;
  draft.match_cpu_time = 0.0;
  draft.deadline_misses = deadline_misses_.load(std::memory_order_relaxed);
  for (std::size_t i = 0; i < draft.X_WO.size(); ++i) {
    draft.X_WO[i] = setup_->scene.objects[i].motion.sample(draft.time);
  }
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& finger = *fingers_[i];
    fill(draft.fingers[i], finger.loop);
    if (finger.device) {
      fill(draft.fingers[i], finger.feedback->latest());
      // Also where no tick tells it: stopped in a pause.
      if (const auto state = finger.device->actuator().line_state()) {
        draft.fingers[i].device_state = state_name(*state);
      }
    }
    if (finger.twin) {
      finger.twin->refresh();
      draft.fingers[i].twin = finger.twin->latest();
    }
    draft.step_cpu_time += finger.loop.record().cpu_time;
    draft.match_cpu_time += finger.known_match_time;
  }
  snapshots_->publish();
}

void SceneRun::end_threads() {
  stop();
  if (thread_.joinable()) thread_.join();
  devices_ending_.store(true);
  for (const auto& finger : fingers_) {
    finger->doorbell.fetch_add(1, std::memory_order_release);
    finger->doorbell.notify_one();
    if (finger->thread.joinable()) finger->thread.join();
    if (finger->twin) finger->twin->end();
  }
}

void SceneRun::retract_devices() {
  std::vector<std::thread> waiting;
  for (const auto& finger : fingers_) {
    if (finger->device) {
      waiting.emplace_back([&device = *finger->device] { device.actuator().finish(); });
    }
  }
  for (std::thread& thread : waiting) thread.join();
}

RunSummary SceneRun::finish() {
  end_threads();
  retract_devices();
  RunSummary summary;
  summary.steps = step_.load();
  if (paced_) summary.deadline_misses = deadline_misses_.load();
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& finger = *fingers_[i];
    FingerSummary one = finger.summary;
    one.merge(finger.device_summary);
    if (finger.device) {
      one.commands_sent = finger.device->actuator().commands_sent();
      if (const auto line = finger.device->actuator().never_opened()) {
        summary.remarks.push_back(
            fmt::format("finger {}: {}", setup_->scene.fingers[i].name, *line));
      }
    }
    summary.all.merge(one);
    one.notices = setup_->notices[i];
    if (setup_->devices[i]) one.mount_shift = setup_->devices[i]->settings().mount_shift;
    summary.fingers.emplace_back(setup_->scene.fingers[i].name, one);
    // A viewer may keep this run a little longer; the ports must be free for the next.
    finger.device.reset();
    // What the page moves it may still offer poses to.
    if (finger.page_tracker == nullptr && finger.webxr_tracker == nullptr) finger.tracker.reset();
  }
  if (recording_) {
    summary.recording = recording_->file();
    summary.dropped_rows = recording_->dropped();
    recording_->close();
  }
  return summary;
}

std::optional<std::string> SceneRun::take_message() {
  for (; notices_told_.finger < fingers_.size(); notices_told_ = {notices_told_.finger + 1, 0}) {
    const auto& notices = setup_->notices[notices_told_.finger];
    if (notices_told_.notice == notices.size()) continue;
    const DeviceNotice& notice = notices[notices_told_.notice++];
    return fmt::format("{}: {}: {}", setup_->scene.fingers[notices_told_.finger].name, notice.key,
                       notice.text);
  }
  for (const auto& finger : fingers_) {
    if (finger->tracker) {
      if (auto message = finger->tracker->take_message()) return message;
    }
    if (!finger->device) continue;
    if (const auto event = finger->device->actuator().take_event()) {
      return finger->device->actuator().message(*event);
    }
  }
  if (!recording_) return std::nullopt;
  if (!told_failed_ && recording_->failed()) {
    told_failed_ = true;
    return fmt::format("{}: can no longer be written; the run goes on unrecorded",
                       recording_->file().string());
  }
  if (!told_dropped_ && recording_->dropped() > 0) {
    told_dropped_ = true;
    return fmt::format("{}: the disk is too slow, rows are missing from the recording",
                       recording_->file().string());
  }
  return std::nullopt;
}

}  // namespace softfinger
