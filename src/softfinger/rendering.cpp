#include "softfinger/rendering.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "softfinger/actuation/guard_program.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/loop/scene_loop.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"

namespace softfinger {
namespace {

constexpr double kLongestGap = 1.0;  // s

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
  if (!options.device.empty()) {
    const Scene read = load_scene(scene);
    named.devices.push_back(read.fingers[finger_index(read, options.finger)].name + "=" +
                            options.device.string());
  }
  if (!options.person.empty()) named.person = options.person;
  return load_setup(named);
}

PoseConditioning conditioning_of(const RenderingOptions& options) {
  PoseConditioning conditioning;
  if (options.filter) conditioning.filter.emplace();
  if (options.predict &&
      !(*options.predict >= 0.0 && *options.predict <= PoseConditioning::kMostLead)) {
    throw InputError(fmt::format("predict {}: must be 0 to {} s", *options.predict,
                                 PoseConditioning::kMostLead));
  }
  conditioning.lead = options.predict;
  return conditioning;
}

/// Of the whole scene's files, so that a replay can load it, and of this finger.
RecordingInfo info_of(const RunSetup& whole, std::size_t finger, const RenderingOptions& options) {
  RecordingInfo info = recording_info(whole);
  info.fingers = {info.fingers[finger]};
  info.fingers.front().poses = conditioning_text(conditioning_of(options), false);
  info.live = options.open_device;
  info.with_state = options.record_state;
  return info;
}

void check_device(const RunSetup& setup) {
  const SceneFinger& finger = setup.scene.fingers.front();
  if (!setup.devices.front()) {
    throw InputError(
        fmt::format("{}: finger {} has no device to open; name one in the scene or in the options, "
                    "or leave open_device false",
                    setup.scene.file.string(), finger.name));
  }
  if (!setup.devices.front()->settings().transport) {
    throw InputError(fmt::format(
        "{}: transport: is missing, there is nothing to open; add a [transport] with the port, or "
        "leave open_device false",
        finger.device->string()));
  }
}

std::filesystem::path guard_of(const RenderingOptions& options) {
  if (options.without_guard_process) return {};
  if (!options.guard_program.empty()) return options.guard_program;
  std::filesystem::path guard = find_guard_program();
  if (guard.empty()) {
    throw InputError(
        "guard_program: softfinger-guard is neither beside this program nor where softfinger was "
        "installed; name it, or set without_guard_process");
  }
  return guard;
}

FingerChainOptions chain_of(const RunSetup& setup, const RenderingOptions& options) {
  if (options.open_device) check_device(setup);
  ActuatorOptions actuator = {.port = "emulator", .simulated_time = true};
  if (options.open_device) {
    actuator = {};
    actuator.guard_program = guard_of(options);
  }
  FingerChainOptions chain = chain_options(setup, 0, actuator);
  chain.with_state = options.record_state && !options.recording.empty();
  return chain;
}

}  // namespace

struct Rendering::Implementation {
  /// What the caller hands over, as a tracker.
  struct HandedPose final : Tracker {
    explicit HandedPose(const TrackedPose& newest) : pose(newest) {}
    TrackedPose sample(double) override { return pose; }
    [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }
    const TrackedPose& pose;
  };

  Implementation(const std::filesystem::path& scene, const RenderingOptions& options)
      : Implementation(load(scene, options), options) {}

  Implementation(const std::shared_ptr<const RunSetup>& whole, const RenderingOptions& options)
      : setup(only_finger(*whole, finger_index(whole->scene, options.finger))),
        rate(setup->scene.simulation_rate),
        conditioned(softfinger::conditioned(std::make_unique<HandedPose>(handed),
                                            conditioning_of(options), false)),
        chain(chain_of(*setup, options)),
        together(setup->scene.objects, setup->scene.gravity, rate, nullptr) {
    together.add(chain);
    if (chain.has_device()) describe_device();
    if (options.recording.empty()) return;
    recording = std::make_unique<RecordingWriter>(
        options.recording, info_of(*whole, finger_index(whole->scene, options.finger), options),
        options.open_device ? RecordingWriter::WhenFull::kDrop : RecordingWriter::WhenFull::kWait,
        chain.loop().record());
  }

  ~Implementation() {
    try {
      close_recording();
    } catch (const OperationError&) {  // close_recording() tells of it
    }
  }

  void close_recording() {
    if (!recording) return;
    together.finish();
    for (const EventRecord& row : together.events()) record(row);
    const std::unique_ptr<RecordingWriter> closing = std::move(recording);
    closing->close();
  }

  void describe_device() {
    const DeviceLoop& device = chain.device();
    command.configuration = device.record().command.configuration;
    command.joints = device.record().command.joints;
    if (const auto& transport = device.device().settings().transport) {
      servo_step = transport->servos.front().step;
      command.set_points.setZero(static_cast<Eigen::Index>(transport->servos.size()));
      command.pulse_widths = command.set_points;
    }
    command.state = state_name(DeviceState::kHoming);
  }

  const RenderingCommand& advance(const TrackedPose& given, double time) {
    const RenderingCommand& told = simulate_to(given, time);
    if (chain.has_device()) tell_stops();
    return told;
  }

  const RenderingCommand& simulate_to(const TrackedPose& given, double time) {
    const auto arrival = std::chrono::steady_clock::now();
    if (!std::isfinite(time)) return command;
    handed = given;
    const TrackedPose target = conditioned->sample(given.time);
    // Nobody was anywhere before the first pose.
    if (!seen) from = target.X_WFt;
    seen = seen || target.valid;
    if (!begun) {
      begun = true;
      origin = time;
      together.start();
      record_objects();
      record(chain.start(TrackedInput(target)));
      return command;
    }
    const auto due = static_cast<std::int64_t>(std::floor((time - origin) * rate + 1e-6));
    std::int64_t steps = due - done;
    if (static_cast<double>(steps) > kLongestGap * rate) {
      origin = time - static_cast<double>(done + 1) / rate;
      steps = 1;
    }
    const Pose start = from;
    for (std::int64_t i = 1; i <= steps; ++i) {
      const double fraction = static_cast<double>(i) / static_cast<double>(steps);
      TrackedPose tracked = target;
      tracked.time = static_cast<double>(++done) / rate;
      if (i < steps) tracked.X_WFt = interpolate(start, target.X_WFt, fraction);
      const TrackedInput input(tracked);
      together.step(done, {&input, 1});
      record_objects();
      if (chain.tick_is_due()) tick(arrival);
      record(chain.seal());
    }
    if (steps > 0) from = target.X_WFt;
    return command;
  }

  void tell_stops() {
    const StopLatch& latch = chain.device().actuator().stop_latch();
    command.stops = latch.newest();
    command.stopped = latch.is_stopped();
    command.stop_confirmed = command.stopped && latch.confirmed() == command.stops;
  }

  void tick(std::chrono::steady_clock::time_point arrival) {
    const TickRecord& tick = chain.tick(chain.tick_input(arrival));
    record(tick);
    command.tick = tick.tick;
    command.time = origin + tick.time;
    command.configuration = tick.command.configuration;
    command.joints = tick.command.joints;
    for (Eigen::Index i = 0; i < command.set_points.size() && i < tick.command.servos; ++i) {
      command.set_points[i] = tick.command.targets[static_cast<std::size_t>(i)] * servo_step;
    }
    command.pulse_widths = command.set_points;
    command.deviation = tick.deviation;
    command.state = state_name(tick.command.state);
  }

  template <typename Record>
  void record(const Record& row) {
    if (recording) recording->push(row);
  }

  void record_objects() {
    for (const ObjectRecord& row : together.objects()) record(row);
    for (const EventRecord& row : together.events()) record(row);
  }

  std::shared_ptr<const RunSetup> setup;  // of the one finger
  double rate;
  TrackedPose handed;                    // by the caller
  std::unique_ptr<Tracker> conditioned;  // what is made of it
  FingerChain chain;
  SceneLoop together;
  std::unique_ptr<RecordingWriter> recording;  // null: none
  RenderingCommand command;
  double servo_step = 0.0;  // set point of one step of the wire
  std::size_t notices_told = 0;
  bool begun = false;
  bool seen = false;      // a valid pose
  double origin = 0.0;    // the caller's time at step 0, s
  std::int64_t done = 0;  // steps
  Pose from;              // tracked pose of the last step
};

Rendering::Rendering(const std::filesystem::path& scene, const RenderingOptions& options)
    : implementation_(std::make_unique<Implementation>(scene, options)) {}
Rendering::~Rendering() = default;
Rendering::Rendering(Rendering&&) noexcept = default;
Rendering& Rendering::operator=(Rendering&&) noexcept = default;

const RenderingCommand& Rendering::step(const Pose& X_WFt, double time) {
  if (!X_WFt.translation.allFinite() || !X_WFt.rotation.allFinite()) return lost(time);
  return implementation_->advance({.time = time, .X_WFt = X_WFt, .valid = true}, time);
}

const RenderingCommand& Rendering::lost(double time) {
  return implementation_->advance({.time = time, .X_WFt = implementation_->from, .valid = false},
                                  time);
}

void Rendering::stop() noexcept {
  FingerChain& chain = implementation_->chain;
  if (chain.has_device()) chain.device().actuator().stop(StopCause::kProgram);
}

bool Rendering::release() noexcept {
  FingerChain& chain = implementation_->chain;
  return chain.has_device() &&
         chain.device().actuator().ask_release(implementation_->command.stops, StopCause::kProgram);
}

std::optional<std::string> Rendering::take_message() {
  const std::vector<DeviceNotice>& notices = implementation_->setup->notices.front();
  if (implementation_->notices_told < notices.size()) {
    const DeviceNotice& notice = notices[implementation_->notices_told++];
    return notice.key + ": " + notice.text;
  }
  FingerChain& chain = implementation_->chain;
  if (!chain.has_device()) return std::nullopt;
  Actuator& actuator = chain.device().actuator();
  const auto event = actuator.take_event();
  return event ? std::optional(actuator.message(*event)) : std::nullopt;
}

RenderingSnapshot Rendering::snapshot() const {
  RenderingSnapshot taken;
  snapshot(taken);
  return taken;
}

void Rendering::snapshot(RenderingSnapshot& snapshot) const {
  const FingerLoop& loop = implementation_->chain.loop();
  const ContactSet& contact = loop.contact();
  snapshot.time = implementation_->origin + loop.record().time;
  snapshot.X_WFt = loop.record().tracked.X_WFt.pose();
  snapshot.X_WF = loop.simulation().bone_pose();
  snapshot.sample_positions_F.clear();
  snapshot.sample_pressures.clear();
  snapshot.in_contact.clear();
  snapshot.X_WO.clear();
  for (const ContactSample& sample : contact.samples) {
    snapshot.sample_positions_F.push_back(sample.position_F);
    snapshot.sample_pressures.push_back(sample.pressure());
    snapshot.in_contact.push_back(sample.touched() > 0.0);
  }
  snapshot.sums() = contact.sums();
  for (std::size_t o = 0; o < implementation_->setup->scene.objects.size(); ++o) {
    snapshot.X_WO.push_back(implementation_->together.object_pose(o));
  }
}

double Rendering::simulation_rate() const { return implementation_->rate; }

double Rendering::device_rate() const {
  const FingerChain& chain = implementation_->chain;
  return chain.has_device() ? softfinger::device_rate(chain.device().device()) : 0.0;
}

int Rendering::joint_count() const {
  const FingerChain& chain = implementation_->chain;
  return chain.has_device() ? chain.device().device().joint_count() : 0;
}

std::vector<std::string> Rendering::configuration_names() const {
  std::vector<std::string> names;
  if (!implementation_->chain.has_device()) return names;
  for (const ConfigurationAxis& axis : implementation_->chain.device().device().axes()) {
    names.push_back(axis.name);
  }
  return names;
}

const std::vector<std::array<int, 3>>& Rendering::skin_triangles() const {
  return implementation_->setup->models.front()->skin_triangles;
}

std::vector<std::string> Rendering::object_names() const {
  std::vector<std::string> names;
  for (const VirtualObject& object : implementation_->setup->scene.objects) {
    names.push_back(object.name);
  }
  return names;
}

std::optional<Pose> Rendering::registration() const {
  const RunSetup& setup = *implementation_->setup;
  const PersonFinger* known =
      setup.person ? setup.person->find(setup.scene.fingers.front().name) : nullptr;
  return known != nullptr ? known->X_BodyFt : std::nullopt;
}

void Rendering::close_recording() { implementation_->close_recording(); }

}  // namespace softfinger
