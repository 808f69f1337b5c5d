#include "softfinger/rendering.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "softfinger/base/error.hpp"
#include "softfinger/loop/device_clock.hpp"
#include "softfinger/loop/device_loop.hpp"
#include "softfinger/loop/finger_loop.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/tracking/conditioned_tracker.hpp"

namespace softfinger {
namespace {

constexpr double kLongestGap = 1.0;  // s

std::size_t finger_index(const Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.fingers.size(); ++i) {
    if (name.empty() || scene.fingers[i].name == name) return i;
    names.push_back(scene.fingers[i].name);
  }
  throw InputError(fmt::format("{}: no finger named {}; there is {}", scene.file.string(), name,
                               fmt::join(names, ", ")));
}

std::shared_ptr<const RunSetup> load(const std::filesystem::path& scene,
                                     const RenderingOptions& options) {
  RunOptions run;
  run.scene = scene;
  if (!options.device.empty()) {
    const Scene read = load_scene(scene);
    run.devices.push_back(read.fingers[finger_index(read, options.finger)].name + "=" +
                          options.device.string());
  }
  if (!options.person.empty()) run.person = options.person;
  return load_setup(run);
}

/// Of the whole scene's files, so that a replay can load it, and of this finger.
RecordingInfo info_of(const RunSetup& whole, std::size_t finger, const RenderingOptions& options) {
  RecordingInfo info = recording_info(whole);
  info.fingers = {info.fingers[finger]};
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

}  // namespace

struct Rendering::Implementation {
  /// What the caller hands over, as a tracker.
  struct HandedPose final : Tracker {
    TrackedPose pose;
    TrackedPose sample(double) override { return pose; }
    [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }
  };

  Implementation(const std::filesystem::path& scene, const RenderingOptions& options)
      : Implementation(load(scene, options), options) {}

  Implementation(const std::shared_ptr<const RunSetup>& whole, const RenderingOptions& options)
      : setup(only_finger(*whole, finger_index(whole->scene, options.finger))),
        rate(setup->scene.simulation_rate),
        loop(0, setup->models.front(), setup->scene.objects, rate,
             options.record_state && !options.recording.empty()),
        clock(rate, rate) {
    auto source = std::make_unique<HandedPose>();
    handed = source.get();
    conditioned = softfinger::conditioned(std::move(source), conditioning_of(options), false);
    if (options.open_device) check_device(*setup);
    if (setup->devices.front()) make_device(options);
    if (options.recording.empty()) return;
    recording = std::make_unique<RecordingWriter>(
        options.recording, info_of(*whole, finger_index(whole->scene, options.finger), options),
        options.open_device ? RecordingWriter::WhenFull::kDrop : RecordingWriter::WhenFull::kWait,
        loop.record());
  }

  void make_device(const RenderingOptions& options) {
    DeviceLoopOptions device_options;
    if (!options.open_device) {
      device_options.actuator.port = "emulator";
      device_options.actuator.simulated_time = true;
    }
    device_options.actuator.ceiling = setup->ceilings.front();
    const Device& description = *setup->devices.front();
    clock = DeviceClock(rate, softfinger::device_rate(description));
    device = std::make_unique<DeviceLoop>(0, setup->devices.front(), setup->models.front(),
                                          device_options);
    command.configuration = device->record().command.configuration;
    command.joints = device->record().command.joints;
    if (description.settings().transport) {
      servo_step = description.settings().transport->servos.front().step;
      command.set_points.setZero(
          static_cast<Eigen::Index>(description.settings().transport->servos.size()));
      command.pulse_widths = command.set_points;
    }
    command.state = state_name(DeviceState::kHoming);
  }

  const RenderingCommand& advance(const TrackedPose& given, double time) {
    const auto arrival = std::chrono::steady_clock::now();
    if (!std::isfinite(time)) return command;
    handed->pose = given;
    const TrackedPose target = conditioned->sample(given.time);
    // Nobody was anywhere before the first pose.
    if (!seen) from = target.X_WFt;
    seen = seen || target.valid;
    if (!begun) {
      begun = true;
      origin = time;
      loop.start(TrackedInput(target));
      record(loop.seal(command.tick, 0));
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
      if (i < steps) tracked.X_WFt = between(start, target.X_WFt, fraction);
      loop.step(done, TrackedInput(tracked));
      if (device && clock.ticks(done)) tick(tracked, arrival);
      record(loop.seal(command.tick, device && command.tick >= 0 ? device->record().hash : 0));
    }
    if (steps > 0) from = target.X_WFt;
    return command;
  }

  static Pose between(const Pose& a, const Pose& b, double fraction) {
    const Vector3 turn = log_rotation(a.rotation.transpose() * b.rotation);
    return {a.rotation * exp_rotation(fraction * turn),
            a.translation + fraction * (b.translation - a.translation)};
  }

  void tick(const TrackedPose& tracked, std::chrono::steady_clock::time_point arrival) {
    const FingerSimulation& simulation = loop.simulation();
    const TickRecord& tick =
        device->tick({.step = done,
                      .time = tracked.time,
                      .tracked = tracked.valid,
                      .taken = arrival,
                      .handed = std::chrono::steady_clock::now()},
                     {loop.contact(), simulation.positions(), simulation.bone_pose()});
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

  std::shared_ptr<const RunSetup> setup;  // of the one finger
  double rate;
  HandedPose* handed = nullptr;
  std::unique_ptr<Tracker> conditioned;  // what is made of it
  FingerLoop loop;
  DeviceClock clock;
  std::unique_ptr<DeviceLoop> device;          // null: none
  std::unique_ptr<RecordingWriter> recording;  // null: none
  RenderingCommand command;
  double servo_step = 0.0;  // set point of one step of the wire
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

RenderingSnapshot Rendering::snapshot() const {
  const FingerLoop& loop = implementation_->loop;
  const ContactSet& contact = loop.contact();
  RenderingSnapshot snapshot;
  snapshot.time = implementation_->origin + loop.record().time;
  snapshot.X_WFt = loop.record().tracked.X_WFt.pose();
  snapshot.X_WF = loop.simulation().bone_pose();
  for (const ContactSample& sample : contact.samples) {
    snapshot.sample_positions_F.push_back(sample.position_F);
    snapshot.sample_pressures.push_back(sample.pressure());
    snapshot.in_contact.push_back(sample.touched() > 0.0);
  }
  snapshot.sums() = contact.sums();
  for (const VirtualObject& object : implementation_->setup->scene.objects) {
    snapshot.X_WO.push_back(object.motion.sample(loop.record().time));
  }
  return snapshot;
}

double Rendering::simulation_rate() const { return implementation_->rate; }

double Rendering::device_rate() const {
  return implementation_->device ? softfinger::device_rate(implementation_->device->device()) : 0.0;
}

std::vector<std::string> Rendering::configuration_names() const {
  std::vector<std::string> names;
  if (!implementation_->device) return names;
  for (const ConfigurationAxis& axis : implementation_->device->device().axes()) {
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

void Rendering::close_recording() {
  const std::unique_ptr<RecordingWriter> recording = std::move(implementation_->recording);
  if (recording) recording->close();
}

}  // namespace softfinger
