#include "softfinger/session/scene_run.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/loop/step_pacer.hpp"
#include "softfinger/threads/awake_processors.hpp"
#include "softfinger/threads/thread_priority.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

constexpr double kSnapshotRate = 60.0;  // Hz
constexpr auto kPausedInterval = std::chrono::milliseconds(5);

}  // namespace

SceneRun::SceneRun(std::shared_ptr<const RunSetup> setup, const RunOptions& options, Mode mode,
                   std::uint64_t generation, Hooks hooks)
    : setup_(std::move(setup)),
      mode_(mode),
      paced_(mode == Mode::kLive || !options.as_fast_as_possible),
      rate_(setup_->scene.simulation_rate),
      hooks_(std::move(hooks)),
      wanted_(setup_->scene),
      snapshot_interval_(
          std::max<std::int64_t>(1, static_cast<std::int64_t>(rate_ / kSnapshotRate))),
      signals_(options.stop_signals) {
  // Before any device opens; created by start(), so that nothing is left behind where another part
  // of the program refuses.
  if (options.recording) refuse_unless_recordable(*options.recording);
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
  for (const SceneHand& hand : setup_->scene.hands) {
    if (hand.script || mode == Mode::kLive) continue;
    throw InputError(fmt::format(
        "hand {}: tracker webxr is a person at the live page; a headless run has none", hand.name));
  }
  const std::size_t count = setup_->scene.fingers.size();
  for (std::size_t i = 0; i < count; ++i) {
    fingers_.push_back(std::make_unique<RunFinger>(*setup_, i, options, mode == Mode::kLive));
  }
  for (const auto& finger : fingers_) {
    finger->open(*setup_, options, mode == Mode::kLive, count == 1 ? team_.get() : nullptr);
  }
  if (options.events) {
    events_sent_ = std::make_unique<EventSender>(*options.events, names_in_events(*setup_));
  }
  const Scene& scene = setup_->scene;
  scene_.emplace(scene.objects, scene.gravity, rate_, team_.get(),
                 options.record_state && options.recording);
  for (const auto& finger : fingers_) scene_->add(*finger->chain);
  tracked_.resize(count);
  const std::optional<double> hands_end = wanted_.end_time();
  if (fingers_.empty() && !hands_end && !options.duration) {
    throw InputError(
        fmt::format("{}: has no finger whose script would end the run; give "
                    "--duration-s",
                    setup_->scene.file.string()));
  }
  std::optional<double> end = options.duration;
  if (!end) {
    end = hands_end.value_or(0.0);
    for (const auto& finger : fingers_) {
      const std::optional<double> one = finger->tracker.end_time();
      end = end && one ? std::optional(std::max(*end, *one)) : std::nullopt;
    }
  }
  // A duration that is a whole number of steps up to rounding is that number.
  if (end) total_steps_ = static_cast<std::int64_t>(std::ceil(*end * rate_ - 1e-6));

  snapshots_ = std::make_unique<SnapshotPublisher>(setup_, generation, fingers_);

  if (options.recording) {
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
    const StepRecord& record = finger->chain->loop().record();
    if (record.nodes_W.size() > largest.nodes_W.size()) largest.nodes_W = record.nodes_W;
    if (record.samples.size() > largest.samples.size()) largest.samples = record.samples;
  }
  RecordingInfo info = recording_info(*setup_);
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    info.fingers[i].poses = fingers_[i]->tracker.conditioning();
  }
  info.live = mode_ == Mode::kLive;
  info.with_state = record_state_;
  recording_ = std::make_unique<RecordingWriter>(
      recording_file_, info,
      mode_ == Mode::kLive ? RecordingWriter::WhenFull::kDrop : RecordingWriter::WhenFull::kWait,
      largest, LogLimits{}, scene_->largest_object());
}

void SceneRun::start() {
  if (!recording_file_.empty()) open_recording();
  for (const auto& finger : fingers_) {
    if (finger->live) finger->live->start(recording_.get(), hooks_.on_loop_thread);
  }
  thread_ = std::thread([this] { simulate(); });
}

double SceneRun::time() const noexcept { return static_cast<double>(step_.load()) / rate_; }

std::optional<double> SceneRun::duration() const {
  if (!total_steps_) return std::nullopt;
  return static_cast<double>(*total_steps_) / rate_;
}

void SceneRun::offer_pose(std::size_t finger, const Pose& X_WFt) noexcept {
  if (finger < fingers_.size()) fingers_[finger]->tracker.offer(X_WFt);
}

void SceneRun::offer_hand(const XrHand& hand) noexcept {
  for (const auto& finger : fingers_) finger->tracker.offer(hand);
  wanted_.offer(hand);
}

void SceneRun::stop_devices(StopCause cause) noexcept {
  bool any = false;
  for (const auto& finger : fingers_) {
    if (Actuator* actuator = finger->actuator()) {
      actuator->stop(cause);
      any = true;
    }
  }
  if (!any) no_device_.confirm(no_device_.stop(cause));
}

bool SceneRun::ask_release(StopLatch::Number stops, StopCause by) noexcept {
  if (stops != this->stops()) return false;
  for (const auto& finger : fingers_) {
    if (Actuator* actuator = finger->actuator()) {
      actuator->ask_release(actuator->stop_latch().newest(), by);
    }
  }
  if (no_device_.ask_release(no_device_.newest(), by)) {
    no_device_.answer_release(ReleaseRefusal::kNone);
  }
  return true;
}

StopLatch::Number SceneRun::stops() const noexcept {
  StopLatch::Number sum = no_device_.newest();
  for (const auto& finger : fingers_) {
    if (const Actuator* actuator = finger->actuator()) sum += actuator->stop_latch().newest();
  }
  return sum;
}

DevicesStopped SceneRun::stopped() const noexcept {
  DevicesStopped stopped{.asked = no_device_.is_stopped(), .confirmed = true};
  for (const auto& finger : fingers_) {
    const Actuator* actuator = finger->actuator();
    if (actuator == nullptr || !actuator->stop_latch().is_stopped()) continue;
    const StopLatch& latch = actuator->stop_latch();
    stopped.asked = true;
    stopped.confirmed = stopped.confirmed && latch.confirmed() == latch.newest();
  }
  return stopped;
}

void SceneRun::lead_by(std::size_t finger, const ObjectiveKind& kind) {
  fingers_[finger]->lead_by(kind);
}

void SceneRun::continue_after(const SceneRun& before) {
  paused_.store(before.paused());
  // What came since the last look of the run before is for this one.
  stop_signals_seen_.store(before.stop_signals_seen_.load());
  release_signals_seen_.store(before.release_signals_seen_.load());
  if (before.stopped().asked) stop_devices(StopCause::kEarlier);
  for (std::size_t i = 0; setup_ == before.setup_ && i < fingers_.size(); ++i) {
    if (const ObjectiveKind* const kind = before.fingers_[i]->led_by) lead_by(i, *kind);
  }
}

void SceneRun::obey_signals() noexcept {
  if (signals_ == nullptr) return;
  // Whoever looks first takes them.
  const std::uint32_t stops = signals_->stops.load(std::memory_order_relaxed);
  if (stop_signals_seen_.exchange(stops, std::memory_order_relaxed) != stops) {
    stop_devices(StopCause::kSignal);
  }
  const std::uint32_t releases = signals_->releases.load(std::memory_order_relaxed);
  if (release_signals_seen_.exchange(releases, std::memory_order_relaxed) != releases) {
    ask_release(this->stops(), StopCause::kSignal);
  }
}

void SceneRun::simulate() {
  std::optional<AwakeProcessors> awake;
  if (paced_) {
    prefer_this_thread(LoopThread::kSimulation);
    awake.emplace();
  }
  scene_->start(wanted_objects(0));
  record_objects();
  for (const auto& finger : fingers_) {
    const StepRecord& record = finger->chain->start(TrackedInput(finger->tracker.sample(0.0)));
    if (recording_) recording_->push(record);
  }
  StepPacer pacer(rate_);
  std::int64_t step = 0;
  while (!stopping_.load(std::memory_order_relaxed) && !(total_steps_ && step >= *total_steps_)) {
    if (paused_.load(std::memory_order_relaxed) && mode_ == Mode::kLive) {
      keep_devices_alive(step);
      publish_snapshot(step, false);
      std::this_thread::sleep_for(kPausedInterval);
      pacer.restart(step + 1);
      continue;
    }
    obey_signals();
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
  scene_->finish();
  tell_events();
  // A run that is stopped before its end, for another scene, has not finished its script.
  if (mode_ == Mode::kLive) publish_snapshot(step, total_steps_ && step >= *total_steps_);
  ended_.store(true);
}

void SceneRun::simulate_step(std::int64_t step) {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    RunFinger& finger = *fingers_[i];
    finger.taken = std::chrono::steady_clock::now();
    finger.tracked = finger.tracker.sample(static_cast<double>(step) / rate_);
    tracked_[i] = TrackedInput(finger.tracked);
  }
  scene_->step(step, tracked_, wanted_objects(step));
  record_objects();
  tell_events();
  for (const auto& finger : fingers_) conclude_step(*finger, step);
}

std::span<const FollowRecord> SceneRun::wanted_objects(std::int64_t step) {
  const std::span<const FollowRecord> wanted =
      wanted_.sample(step, static_cast<double>(step) / rate_);
  for (std::size_t o = 0; recording_ && o < wanted.size(); ++o) {
    if (wanted_.changed(o)) recording_->push(wanted[o]);
  }
  return wanted;
}

void SceneRun::record_objects() {
  if (!recording_) return;
  for (const ObjectRecord& record : scene_->objects()) recording_->push(record);
}

void SceneRun::tell_events() {
  for (const EventRecord& record : scene_->events()) {
    if (recording_) recording_->push(record);
    if (events_sent_) events_sent_->send(record);
    EventRecord* const told = mode_ == Mode::kLive ? events_told_.claim() : nullptr;
    if (told == nullptr) continue;
    *told = record;
    events_told_.publish();
  }
}

std::optional<EventRecord> SceneRun::take_event() {
  const EventRecord* const oldest = events_told_.front();
  if (oldest == nullptr) return std::nullopt;
  const EventRecord event = *oldest;
  events_told_.release();
  return event;
}

void SceneRun::conclude_step(RunFinger& finger, std::int64_t step) {
  FingerChain& chain = *finger.chain;
  if (chain.tick_is_due()) {
    TickInput input = chain.tick_input(finger.taken);
    note_way_here(finger.tracked, static_cast<double>(step) / rate_, input);
    if (finger.live) {
      finger.live->hand_over(input);
    } else {
      tick_here(finger, input);
    }
  }
  if (finger.live) finger.live->take_feedback();
  const StepRecord& record = chain.seal();
  if (recording_) recording_->push(record);
  finger.summary.add(record);
}

void SceneRun::tick_here(RunFinger& finger, const TickInput& input) {
  const TickRecord& tick = finger.chain->tick(input);
  if (recording_) recording_->push(tick);
  finger.summary.add(tick);
  if (hooks_.on_tick) hooks_.on_tick(static_cast<std::size_t>(tick.finger), *finger.chain);
}

void SceneRun::keep_devices_alive(std::int64_t step) {
  obey_signals();
  const auto now = std::chrono::steady_clock::now();
  for (const auto& finger : fingers_) {
    if (!finger->live) continue;
    // The run's time stands still, and with it the time for which tracking is lost; where nothing
    // more is handed over the device retracts.
    if (finger->tracker.sample(static_cast<double>(step) / rate_).valid) {
      finger->lost_in_pause.reset();
    } else if (!finger->lost_in_pause) {
      finger->lost_in_pause = now;
    }
    const auto lost = now - finger->lost_in_pause.value_or(now);
    if (lost < std::chrono::duration<double>(kHoldTime)) finger->live->hand_over_again();
    finger->live->take_feedback();
  }
}

void SceneRun::publish_snapshot(std::int64_t step, bool finished) {
  snapshots_->publish({.step = step,
                       .time = static_cast<double>(step) / rate_,
                       .paused = paused_.load(std::memory_order_relaxed),
                       .stops = stops(),
                       .stopped = stopped(),
                       .finished = finished,
                       .deadline_misses = deadline_misses_.load(std::memory_order_relaxed)},
                      *scene_, fingers_);
}

void SceneRun::end_threads() {
  stop();
  if (thread_.joinable()) thread_.join();
  for (const auto& finger : fingers_) {
    if (finger->live) finger->live->stop();
  }
  for (const auto& finger : fingers_) {
    if (finger->live) finger->live->join();
  }
}

void SceneRun::retract_devices() {
  std::vector<std::thread> waiting;
  for (const auto& finger : fingers_) {
    if (finger->chain && finger->chain->has_device()) {
      waiting.emplace_back([&chain = *finger->chain] { chain.finish(); });
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
    const std::string& name = setup_->scene.fingers[i].name;
    RunFinger& finger = *fingers_[i];
    FingerSummary one = finger.summary;
    if (finger.live) one.merge(finger.live->summary());
    if (finger.chain->has_device()) {
      const Actuator& actuator = finger.chain->device().actuator();
      one.commands_sent = actuator.commands_sent();
      if (const auto line = actuator.never_opened()) {
        summary.remarks.push_back(fmt::format("finger {}: {}", name, *line));
      }
    }
    summary.all.merge(one);
    one.notices = setup_->notices[i];
    if (setup_->devices[i]) one.mount_shift = setup_->devices[i]->settings().mount_shift;
    summary.fingers.emplace_back(name, one);
    finger.close();
  }
  for (const ObjectRecord& last : scene_->objects()) {
    const VirtualObject& object = setup_->scene.objects[static_cast<std::size_t>(last.object)];
    const std::optional<Joint> joint = object.dynamics ? object.dynamics->joint : std::nullopt;
    const bool slides = joint && joint->kind == JointKind::kSlider;
    summary.objects.push_back({object.name,
                               slides                   ? "mm"
                               : std::isnan(last.joint) ? ""
                                                        : "deg",
                               last});
  }
  summary.all.unconverged_steps += scene_->unconverged_steps();
  for (const Overlap& overlap : scene_->overlaps()) {
    const auto& objects = setup_->scene.objects;
    const bool at_start = overlap.time == 0.0;
    summary.remarks.push_back(
        fmt::format("objects {} and {} {} {:.2g} mm inside each other{} and part slowly",
                    objects[overlap.first].name, objects[overlap.second].name,
                    at_start ? "start" : "are", overlap.depth / mm,
                    at_start ? "" : fmt::format(" when a hand appears at {:.3f} s", overlap.time)));
  }
  if (recording_) {
    summary.recording = recording_->file();
    summary.dropped_rows = recording_->dropped();
    recording_->close();
  }
  return summary;
}

std::optional<std::string> SceneRun::take_message() {
  std::optional<std::string> message = messages_.take(*setup_, fingers_, recording_.get());
  if (message && recording_) {
    const std::int64_t step = step_.load(std::memory_order_relaxed);
    recording_->push(step, static_cast<double>(step) / rate_, *message);
  }
  return message;
}

}  // namespace softfinger
