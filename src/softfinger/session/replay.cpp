#include "softfinger/session/replay.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/loop/scene_loop.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/recorded_files.hpp"
#include "softfinger/session/run_setup.hpp"

namespace softfinger {
namespace {

template <typename Row>
bool same_bytes(const std::vector<Row>& a, const std::vector<Row>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(static_cast<const void*>(a.data()),
                                                           static_cast<const void*>(b.data()),
                                                           a.size() * sizeof(Row)) == 0);
}

/// Runs the chains of a recording again, row by row.
class Replayer {
 public:
  Replayer(std::shared_ptr<const RunSetup> setup, bool with_state) : setup_(std::move(setup)) {
    const Scene& scene = setup_->scene;
    scene_.emplace(scene.objects, scene.gravity, scene.simulation_rate, nullptr, with_state);
    wanted_.resize(scene.objects.size());
    for (std::size_t i = 0; i < setup_->models.size(); ++i) {
      FingerChainOptions options =
          chain_options(*setup_, i, {.port = "emulator", .simulated_time = true});
      options.with_state = with_state;
      options.device_loop.replay = true;
      fingers_.push_back({std::make_unique<FingerChain>(options), {}});
      scene_->add(*fingers_.back().chain);
    }
  }

  /// Where an object is wanted from the next step on.
  void want(const FollowRecord& recorded) {
    const auto object = static_cast<std::size_t>(recorded.object);
    if (object < wanted_.size()) wanted_[object] = recorded;
  }

  /// The part of a step that only needs the recorded poses: a row a finger.
  void simulate(std::int64_t step, std::span<const StepRecord> recorded) {
    tracked_.clear();
    for (const StepRecord& row : recorded) tracked_.push_back(row.tracked);
    if (step > 0) {
      scene_->step(step, tracked_, wanted_);
      return;
    }
    scene_->start(wanted_);
    for (std::size_t i = 0; i < fingers_.size(); ++i) fingers_[i].chain->start(tracked_[i]);
  }

  /// Where objects are that move by the forces on them.
  [[nodiscard]] std::span<const ObjectRecord> objects() const { return scene_->objects(); }
  /// What the last step, or the end, tells of them.
  [[nodiscard]] std::span<const EventRecord> events() const { return scene_->events(); }
  void finish_objects() { scene_->finish(); }

  /// What differs in a tick of the step just simulated; null: nothing.
  const char* tick(const TickRecord& recorded) {
    Finger& finger = finger_of(recorded);
    if (!finger.chain->has_device()) return "device tick";
    finger.chain->device().replay_reading(recorded.reading);
    lead(finger.chain->device(), recorded);
    TickInput input = finger.chain->tick_input(std::chrono::steady_clock::now());
    input.step = recorded.step;
    input.time = recorded.time;
    input.tracked = recorded.tracked;
    input.emergency = recorded.emergency;
    const TickRecord& tick = finger.chain->tick(input);
    finger.tick_hashes[tick.tick] = tick.hash;
    return first_difference(recorded, tick);
  }

  const char* finish(const StepRecord& recorded) {
    Finger& finger = finger_of(recorded);
    // In a live run steps learn of ticks some steps later.
    const auto tick = finger.tick_hashes.find(recorded.tick);
    finger.chain->know(recorded.tick, tick == finger.tick_hashes.end() ? 0 : tick->second);
    const StepRecord& record = finger.chain->seal();
    // Later steps know this tick or newer ones.
    finger.tick_hashes.erase(finger.tick_hashes.begin(),
                             finger.tick_hashes.lower_bound(recorded.tick));
    if (const char* difference = first_difference(recorded, record)) return difference;
    if (!same_bytes(recorded.nodes_W, record.nodes_W)) return "nodes";
    if (!same_bytes(recorded.samples, record.samples)) return "samples";
    return nullptr;
  }

 private:
  struct Finger {
    std::unique_ptr<FingerChain> chain;
    std::map<std::int64_t, std::uint64_t> tick_hashes;
  };

  /// By what led then; a recording that does not say it was led by what the device file says.
  static void lead(DeviceLoop& device, const TickRecord& recorded) {
    if (std::isnan(recorded.objective) || recorded.objective == device.record().objective) return;
    const ObjectiveKind* const kind = objective_numbered(recorded.objective);
    if (kind == nullptr || !why_not(*kind, device.device()).empty()) {
      throw InputError(
          fmt::format("the recording has objective {} at device tick {}, which {}; replay it with "
                      "the program that made it",
                      recorded.objective, recorded.tick,
                      kind == nullptr ? "is none of this program's" : "its device cannot have"));
    }
    device.lead_by(*kind);
  }

  template <typename Record>
  Finger& finger_of(const Record& record) {
    return fingers_[static_cast<std::size_t>(record.finger)];
  }

  std::shared_ptr<const RunSetup> setup_;
  std::optional<SceneLoop> scene_;
  std::vector<Finger> fingers_;
  std::vector<TrackedInput> tracked_;
  std::vector<FollowRecord> wanted_;
};

}  // namespace

ReplayResult replay(const ReplayOptions& options, const std::function<void(double)>& progress) {
  RecordingReader reader(options.recording);
  const RecordingInfo& info = reader.info();
  std::unique_ptr<RecordedFiles> files;
  SetupOptions original;
  if (options.scene) {
    original.scene = *options.scene;
  } else {
    files = std::make_unique<RecordedFiles>(info, options.recording);
    original = files->setup_options();
  }
  if (options.person) original.person = options.person;
  original.load_observer = options.load_observer;
  std::shared_ptr<const RunSetup> setup = load_setup(original);
  // A program with a loop of its own runs and records one finger of a scene.
  if (info.fingers.size() == 1 && setup->scene.fingers.size() > 1) {
    for (std::size_t i = 0; i < setup->scene.fingers.size(); ++i) {
      if (setup->scene.fingers[i].name == info.fingers.front().name) {
        setup = only_finger(*setup, i);
        break;
      }
    }
  }
  if (setup->scene.fingers.size() != info.fingers.size()) {
    throw InputError(fmt::format("{}: has {} fingers, the recording {} has {}",
                                 setup->scene.file.string(), setup->scene.fingers.size(),
                                 options.recording.string(), info.fingers.size()));
  }
  Replayer replayer(setup, info.with_state);

  ReplayResult result;
  result.steps = reader.last_step();
  result.cut = reader.how_it_was_cut();
  const auto differ = [&](std::int64_t step, std::int64_t finger, const char* what) {
    result.agree = false;
    result.first_difference = step;
    result.difference = info.fingers.size() > 1
                            ? fmt::format("{} of finger {}", what,
                                          info.fingers[static_cast<std::size_t>(finger)].name)
                            : what;
    return result;
  };

  const auto differ_in_object = [&](std::int64_t step, std::int64_t object) {
    result.agree = false;
    result.first_difference = step;
    result.difference =
        fmt::format("object {}", setup->scene.objects[static_cast<std::size_t>(object)].name);
    return result;
  };
  // The object of the first event that differs.
  const auto other_event = [&]() -> std::optional<std::int64_t> {
    if (info.object_names.empty()) return {};
    for (const EventRecord& event : replayer.events()) {
      EventRecord recorded;
      const bool there = reader.next(recorded);
      if (!there && !reader.complete()) return {};
      if (!there || first_difference(recorded, event) != nullptr) return event.object;
    }
    return {};
  };
  std::vector<StepRecord> rows(info.fingers.size());
  TickRecord tick;
  bool more_ticks = reader.next(tick);
  FollowRecord follow;
  bool more_follow = reader.next(follow);
  for (std::int64_t step = 0; step <= result.steps; ++step) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto finger = static_cast<std::int64_t>(i);
      const bool there = reader.next(rows[i]);
      // A cut may fall between the fingers of a step.
      if (!there && step == result.steps && !reader.complete()) return result;
      if (!there || rows[i].step != step || rows[i].finger != finger) {
        return differ(step, finger, "a missing row");
      }
    }
    for (; more_follow && follow.step <= step; more_follow = reader.next(follow)) {
      replayer.want(follow);
    }
    replayer.simulate(step, rows);
    for (const StepRecord& row : rows) {
      while (more_ticks && tick.step == step && tick.finger == row.finger) {
        if (const char* what = replayer.tick(tick)) return differ(step, row.finger, what);
        more_ticks = reader.next(tick);
      }
      if (const char* what = replayer.finish(row)) return differ(step, row.finger, what);
    }
    for (const ObjectRecord& object : replayer.objects()) {
      ObjectRecord recorded;
      const bool there = reader.next(recorded);
      // Or between the rows of fingers and those of objects.
      if (!there && !reader.complete()) return result;
      // Older recordings lack nodes of soft objects.
      const bool other_nodes =
          !recorded.nodes_W.empty() && !same_bytes(recorded.nodes_W, object.nodes_W);
      if (!there || other_nodes || first_difference(recorded, object) != nullptr) {
        return differ_in_object(step, object.object);
      }
    }
    if (const auto other = other_event()) return differ_in_object(step, *other);
    if (progress && result.steps > 0 && step % 20 == 0) {
      progress(static_cast<double>(step) / static_cast<double>(result.steps));
    }
  }
  if (!reader.complete()) return result;
  replayer.finish_objects();
  if (const auto other = other_event()) return differ_in_object(result.steps, *other);
  return result;
}

std::string recorded_instruction_set(const std::filesystem::path& recording) {
  return RecordingReader(recording).info().instruction_set;
}

}  // namespace softfinger
