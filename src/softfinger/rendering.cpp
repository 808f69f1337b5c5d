#include "softfinger/rendering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "softfinger/base/error.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/loop/scene_loop.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/rendered_finger.hpp"
#include "softfinger/session/run_objects.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"

namespace softfinger {
namespace {

constexpr double kLongestGap = 1.0;  // s
constexpr int kMostThreads = 256;

std::size_t finger_index(const Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.fingers.size(); ++i) {
    if (name.empty() || scene.fingers[i].name == name) return i;
    names.push_back(scene.fingers[i].name);
  }
  if (names.empty()) throw InputError(fmt::format("{}: has no finger", scene.file.string()));
  throw InputError(fmt::format("{}: no finger named {}; there is {}", scene.file.string(), name,
                               fmt::join(names, ", ")));
}

std::shared_ptr<const RunSetup> load(const std::filesystem::path& given,
                                     const RenderingOptions& options) {
  const std::filesystem::path scene = file_or_shipped(Shipped::kScene, given.native());
  SetupOptions named;
  named.scene = scene;
  if (!options.device.empty() && options.all_fingers) {
    named.devices.push_back(options.device.string());
  } else if (!options.device.empty()) {
    const Scene read = load_scene(scene);
    named.devices.push_back(read.fingers[finger_index(read, options.finger)].name + "=" +
                            options.device.string());
  }
  if (!options.person.empty()) named.person = options.person;
  return load_setup(named);
}

/// Of the whole scene's files, so that a replay can load it, and of the fingers that are rendered.
RecordingInfo info_of(const RunSetup& whole, const RenderingOptions& options) {
  RecordingInfo info = recording_info(whole);
  if (!options.all_fingers)
    info.fingers = {info.fingers[finger_index(whole.scene, options.finger)]};
  for (RecordingInfo::Finger& finger : info.fingers) {
    finger.poses = conditioning_text(conditioning_of(options), false);
  }
  info.live = options.open_device;
  info.with_state = options.record_state;
  return info;
}

/// Its objects may be moved from outside.
std::shared_ptr<RunSetup> rendered(const RunSetup& whole, const RenderingOptions& options) {
  const std::size_t first = finger_index(whole.scene, options.finger);
  return std::make_shared<RunSetup>(options.all_fingers ? whole : *only_finger(whole, first));
}

bool is_finite(const Pose& pose) {
  return pose.translation.allFinite() && pose.rotation.allFinite();
}

}  // namespace

struct Rendering::Implementation {
  /// How an object moves that its caller leads.
  struct LedObject {
    bool led = false;
    Pose from, to;
  };

  /// Events that nobody has taken yet, the newest of them.
  class EventQueue {
   public:
    void put(const RenderingEvent& event) {
      if (count_ == events_.size()) take();
      events_[(first_ + count_++) % events_.size()] = event;
    }
    std::optional<RenderingEvent> take() {
      if (count_ == 0) return std::nullopt;
      const RenderingEvent event = events_[first_];
      first_ = (first_ + 1) % events_.size();
      --count_;
      return event;
    }

   private:
    std::array<RenderingEvent, 256> events_{};
    std::size_t first_ = 0, count_ = 0;
  };

  Implementation(const std::filesystem::path& scene, const RenderingOptions& options)
      : Implementation(load(scene, options), options) {}

  Implementation(const std::shared_ptr<const RunSetup>& whole, const RenderingOptions& options)
      : setup(rendered(*whole, options)),
        rate(setup->scene.simulation_rate),
        led(setup->scene.objects.size()) {
    if (options.threads < 1 || options.threads > kMostThreads) {
      throw InputError(fmt::format("threads {}: must be 1 to {}", options.threads, kMostThreads));
    }
    if (options.threads > 1) team.emplace(options.threads);
    ThreadTeam* const shared = team ? &*team : nullptr;
    together.emplace(setup->scene.objects, setup->scene.gravity, rate, shared,
                     options.record_state && !options.recording.empty());
    wanted.emplace(setup->scene);
    for (std::size_t i = 0; i < setup->scene.fingers.size(); ++i) {
      fingers.push_back(std::make_unique<RenderedFinger>(*setup, i, options, shared));
      together->add(fingers.back()->chain());
    }
    tracked.resize(fingers.size());
    if (options.recording.empty()) return;
    StepRecord largest;
    for (const auto& finger : fingers) {
      const StepRecord& step = finger->chain().loop().record();
      if (step.nodes_W.size() > largest.nodes_W.size()) largest.nodes_W = step.nodes_W;
      if (step.samples.size() > largest.samples.size()) largest.samples = step.samples;
    }
    recording = std::make_unique<RecordingWriter>(
        options.recording, info_of(*whole, options),
        options.open_device ? RecordingWriter::WhenFull::kDrop : RecordingWriter::WhenFull::kWait,
        largest, LogLimits{}, together->largest_object());
  }

  ~Implementation() {
    try {
      close_recording();
    } catch (const OperationError&) {  // close_recording() tells of it
    }
    retract();
  }

  /// All at once: each may take a second.
  void retract() {
    std::vector<std::thread> waiting;
    for (std::size_t i = 1; i < fingers.size(); ++i) {
      waiting.emplace_back([&chain = fingers[i]->chain()] { chain.finish(); });
    }
    if (!fingers.empty()) fingers.front()->chain().finish();
    for (std::thread& thread : waiting) thread.join();
  }

  void close_recording() {
    if (!recording) return;
    together->finish();
    for (const EventRecord& row : together->events()) record(row);
    const std::unique_ptr<RecordingWriter> closing = std::move(recording);
    closing->close();
  }

  /// Each finger has been handed its pose of that time.
  void advance(double time) {
    simulate_to(time);
    for (const auto& finger : fingers) finger->tell_stops();
  }

  void simulate_to(double time) {
    const auto arrival = std::chrono::steady_clock::now();
    if (!begun) {
      begun = true;
      origin = time;
      together->start(wanted_objects(0));
      record_objects();
      for (const auto& finger : fingers) record(finger->chain().start(finger->target()));
      return;
    }
    const auto due = static_cast<std::int64_t>(std::floor((time - origin) * rate + 1e-6));
    std::int64_t steps = due - done;
    if (static_cast<double>(steps) > kLongestGap * rate) {
      origin = time - static_cast<double>(done + 1) / rate;
      steps = 1;
    }
    for (std::int64_t i = 1; i <= steps; ++i) {
      const double at = static_cast<double>(++done) / rate;
      for (std::size_t f = 0; f < fingers.size(); ++f) {
        tracked[f] = fingers[f]->on_the_way(i, steps, at);
      }
      lead_objects(i, steps);
      together->step(done, tracked, wanted_objects(done));
      record_objects();
      for (const auto& finger : fingers) {
        if (finger->chain().tick_is_due()) record(finger->tick(arrival, origin));
        record(finger->chain().seal());
      }
    }
    if (steps <= 0) return;
    for (const auto& finger : fingers) finger->arrive();
  }

  /// As scripts of hands say; a headset is nobody's who calls.
  std::span<const FollowRecord> wanted_objects(std::int64_t step) {
    const auto rows = wanted->sample(step, static_cast<double>(step) / rate);
    for (std::size_t o = 0; o < rows.size(); ++o) {
      if (wanted->changed(o)) record(rows[o]);
    }
    return rows;
  }

  void lead_objects(std::int64_t step, std::int64_t count) {
    for (std::size_t o = 0; o < led.size(); ++o) {
      LedObject& object = led[o];
      if (!object.led) continue;
      const double part = static_cast<double>(step) / static_cast<double>(count);
      setup->scene.objects[o].motion.hold(step < count ? interpolate(object.from, object.to, part)
                                                       : object.to);
      if (step == count) object.from = object.to;
    }
  }

  /// Why the caller cannot lead an object, for people; null: it can.
  [[nodiscard]] const char* why_not_led(std::size_t o) const {
    const std::vector<VirtualObject>& objects = setup->scene.objects;
    const auto hangs_on_it = [o](const VirtualObject& other) {
      return other.dynamics && other.dynamics->joint &&
             other.dynamics->joint->parent == static_cast<int>(o);
    };
    if (objects[o].moves_by_forces()) return "moves by forces";
    if (std::ranges::any_of(objects, hangs_on_it)) return "has something hang on it by a joint";
    if (recording) return "is recorded, and a replay would not know of this";
    return nullptr;
  }

  void lead_object(std::size_t o, const Pose& X_WO) {
    std::vector<VirtualObject>& objects = setup->scene.objects;
    if (o >= objects.size()) {
      throw InputError(fmt::format("object {}: there are {}", o, objects.size()));
    }
    const char* const why = is_finite(X_WO) ? why_not_led(o) : "needs a finite pose";
    if (why != nullptr) throw InputError(fmt::format("object {}: {}", objects[o].name, why));
    LedObject& object = led[o];
    object.from = begun ? together->object_pose(o) : X_WO;
    object.to = X_WO;
    object.led = true;
    if (!begun) objects[o].motion.hold(X_WO);
  }

  template <typename Record>
  void record(const Record& row) {
    if (recording) recording->push(row);
  }

  void record_objects() {
    for (const ObjectRecord& row : together->objects()) record(row);
    for (const EventRecord& row : together->events()) {
      record(row);
      events.put(told(row));
    }
  }

  [[nodiscard]] RenderingEvent told(const EventRecord& row) const {
    RenderingEvent event{.time = origin + row.time,
                         .kind = kEventKinds[static_cast<std::size_t>(row.kind)],
                         .object = static_cast<std::size_t>(row.object),
                         .impulse = row.impulse};
    if (row.other < 0) return event;
    const auto other = static_cast<std::size_t>(row.other);
    const std::size_t objects = setup->scene.objects.size();
    (other < objects ? event.other_object : event.other_finger) =
        other < objects ? other : other - objects;
    return event;
  }

  std::shared_ptr<RunSetup> setup;  // of the fingers that are rendered
  double rate;
  std::vector<LedObject> led;      // one an object
  std::optional<ThreadTeam> team;  // none: one thread
  std::optional<SceneLoop> together;
  std::vector<std::unique_ptr<RenderedFinger>> fingers;
  std::optional<RunObjects> wanted;
  std::vector<TrackedInput> tracked;           // of each, of the step under way
  std::unique_ptr<RecordingWriter> recording;  // null: none
  EventQueue events;
  bool begun = false;
  double origin = 0.0;    // the caller's time at step 0, s
  std::int64_t done = 0;  // steps
};

Rendering::Rendering(const std::filesystem::path& scene, const RenderingOptions& options)
    : implementation_(std::make_unique<Implementation>(scene, options)) {}
Rendering::~Rendering() = default;
Rendering::Rendering(Rendering&&) noexcept = default;
Rendering& Rendering::operator=(Rendering&&) noexcept = default;

const RenderingCommand& Rendering::step(const Pose& X_WFt, double time) {
  const std::optional<Pose> one(X_WFt);
  step({&one, 1}, time);
  return command();
}

const RenderingCommand& Rendering::lost(double time) {
  if (!std::isfinite(time)) return command();
  for (const auto& finger : implementation_->fingers) finger->hand_over(std::nullopt, time);
  implementation_->advance(time);
  return command();
}

void Rendering::step(std::span<const std::optional<Pose>> X_WFt, double time) {
  const auto& fingers = implementation_->fingers;
  if (X_WFt.size() != fingers.size()) {
    throw InputError(fmt::format("{} poses for {} fingers: there must be one for each",
                                 X_WFt.size(), fingers.size()));
  }
  if (!std::isfinite(time)) return;
  for (std::size_t i = 0; i < fingers.size(); ++i) fingers[i]->hand_over(X_WFt[i], time);
  implementation_->advance(time);
}

const RenderingCommand& Rendering::command(std::size_t finger) const {
  return implementation_->fingers[finger]->command();
}

void Rendering::move_object(std::size_t object, const Pose& X_WO) {
  implementation_->lead_object(object, X_WO);
}

void Rendering::stop() noexcept {
  for (const auto& finger : implementation_->fingers) {
    if (Actuator* const actuator = finger->actuator()) actuator->stop(StopCause::kProgram);
  }
}

bool Rendering::release() noexcept {
  bool asked = false;
  bool stopped_again = false;
  for (const auto& finger : implementation_->fingers) {
    Actuator* const actuator = finger->actuator();
    if (actuator == nullptr || !actuator->stop_latch().is_stopped()) continue;
    const bool can = actuator->ask_release(finger->command().stops, StopCause::kProgram);
    asked = asked || can;
    stopped_again = stopped_again || !can;
  }
  return asked && !stopped_again;
}

std::optional<std::string> Rendering::take_message() {
  const auto& fingers = implementation_->fingers;
  for (std::size_t i = 0; i < fingers.size(); ++i) {
    auto message = fingers[i]->take_message();
    if (!message) continue;
    if (fingers.size() == 1) return message;
    return implementation_->setup->scene.fingers[i].name + ": " + *message;
  }
  return std::nullopt;
}

std::optional<RenderingEvent> Rendering::take_event() { return implementation_->events.take(); }

RenderingSnapshot Rendering::snapshot() const {
  RenderingSnapshot taken;
  snapshot(taken);
  return taken;
}

void Rendering::snapshot(RenderingSnapshot& snapshot, std::size_t finger) const {
  const FingerLoop& loop = implementation_->fingers[finger]->chain().loop();
  const ContactSet& contact = loop.contact();
  snapshot.time = implementation_->origin + loop.record().time;
  snapshot.X_WFt = loop.record().tracked.X_WFt.pose();
  snapshot.X_WF = loop.simulation().bone_pose();
  snapshot.sample_positions_F.clear();
  snapshot.sample_pressures.clear();
  snapshot.in_contact.clear();
  snapshot.X_WO.clear();
  snapshot.objects.clear();
  for (const ContactSample& sample : contact.samples) {
    snapshot.sample_positions_F.push_back(sample.position_F);
    snapshot.sample_pressures.push_back(sample.pressure());
    snapshot.in_contact.push_back(sample.touched() > 0.0);
  }
  snapshot.sums() = contact.sums();
  const SceneLoop& together = *implementation_->together;
  for (std::size_t o = 0; o < implementation_->setup->scene.objects.size(); ++o) {
    snapshot.X_WO.push_back(together.object_pose(o));
    snapshot.objects.push_back({.X_WO = snapshot.X_WO.back()});
  }
  for (const ObjectRecord& record : together.objects()) {
    RenderingObject& object = snapshot.objects[static_cast<std::size_t>(record.object)];
    object.moves = true;
    object.velocity = record.velocity;
    object.angular_velocity = record.angular_velocity;
    object.joint = record.joint;
  }
}

double Rendering::simulation_rate() const { return implementation_->rate; }

std::size_t Rendering::finger_count() const { return implementation_->fingers.size(); }

std::vector<std::string> Rendering::finger_names() const {
  std::vector<std::string> names;
  for (const SceneFinger& finger : implementation_->setup->scene.fingers) {
    names.push_back(finger.name);
  }
  return names;
}

double Rendering::device_rate(std::size_t finger) const {
  const FingerChain& chain = implementation_->fingers[finger]->chain();
  return chain.has_device() ? softfinger::device_rate(chain.device().device()) : 0.0;
}

int Rendering::joint_count(std::size_t finger) const {
  const FingerChain& chain = implementation_->fingers[finger]->chain();
  return chain.has_device() ? chain.device().device().joint_count() : 0;
}

std::vector<std::string> Rendering::configuration_names(std::size_t finger) const {
  return implementation_->fingers[finger]->configuration_names();
}

const std::vector<std::array<int, 3>>& Rendering::skin_triangles(std::size_t finger) const {
  return implementation_->fingers[finger]->skin_triangles();
}

std::vector<std::string> Rendering::object_names() const {
  std::vector<std::string> names;
  for (const VirtualObject& object : implementation_->setup->scene.objects) {
    names.push_back(object.name);
  }
  return names;
}

const std::vector<std::array<int, 3>>& Rendering::object_triangles(std::size_t object) const {
  static const std::vector<std::array<int, 3>> kNone;
  const auto& soft = implementation_->setup->scene.objects[object].soft;
  return soft ? soft->skin_triangles : kNone;
}

void Rendering::object_positions(std::size_t object, std::vector<Vector3>& positions_W) const {
  positions_W.clear();
  const auto& soft = implementation_->setup->scene.objects[object].soft;
  if (!soft) return;
  const std::span<const Vector3> nodes = implementation_->together->object_nodes(object);
  for (const int node : soft->sample_nodes) {
    positions_W.push_back(nodes[static_cast<std::size_t>(node)]);
  }
}

std::optional<Pose> Rendering::registration(std::size_t finger) const {
  const RunSetup& setup = *implementation_->setup;
  const PersonFinger* known =
      setup.person ? setup.person->find(setup.scene.fingers[finger].name) : nullptr;
  return known != nullptr ? known->X_BodyFt : std::nullopt;
}

void Rendering::close_recording() { implementation_->close_recording(); }

}  // namespace softfinger
