#include "softfinger/rendered_finger.hpp"

#include <fmt/format.h>

#include <utility>

#include "softfinger/actuation/guard_program.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"

namespace softfinger {
namespace {

void check_device(const RunSetup& setup, std::size_t number) {
  const SceneFinger& finger = setup.scene.fingers[number];
  if (!setup.devices[number]) {
    throw InputError(
        fmt::format("{}: finger {} has no device to open; name one in the scene or in the options, "
                    "or leave open_device false",
                    setup.scene.file.string(), finger.name));
  }
  if (!setup.devices[number]->settings().transport) {
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

FingerChainOptions chain_of(const RunSetup& setup, std::size_t number,
                            const RenderingOptions& options, ThreadTeam* team) {
  ActuatorOptions actuator = {.port = "emulator", .simulated_time = true};
  if (options.open_device) {
    check_device(setup, number);
    actuator = {};
    actuator.guard_program = guard_of(options);
  }
  FingerChainOptions chain = chain_options(setup, number, actuator);
  chain.with_state = options.record_state && !options.recording.empty();
  chain.team = team;
  return chain;
}

}  // namespace

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

RenderedFinger::RenderedFinger(const RunSetup& setup, std::size_t number,
                               const RenderingOptions& options, ThreadTeam* team)
    : model_(setup.models[number]),
      notices_(setup.notices[number]),
      conditioned_(
          conditioned(std::make_unique<HandedPose>(handed_), conditioning_of(options), false)),
      chain_(chain_of(setup, number, options, team)) {
  if (!chain_.has_device()) return;
  const DeviceLoop& device = chain_.device();
  command_.configuration = device.record().command.configuration;
  command_.joints = device.record().command.joints;
  if (const auto& transport = device.device().settings().transport) {
    servo_step_ = transport->servos.front().step;
    command_.set_points.setZero(static_cast<Eigen::Index>(transport->servos.size()));
    command_.pulse_widths = command_.set_points;
  }
  command_.state = state_name(DeviceState::kHoming);
}

Actuator* RenderedFinger::actuator() {
  return chain_.has_device() ? &chain_.device().actuator() : nullptr;
}

const Actuator* RenderedFinger::actuator() const {
  return chain_.has_device() ? &chain_.device().actuator() : nullptr;
}

std::vector<std::string> RenderedFinger::configuration_names() const {
  std::vector<std::string> names;
  if (!chain_.has_device()) return names;
  for (const ConfigurationAxis& axis : chain_.device().device().axes()) names.push_back(axis.name);
  return names;
}

std::optional<std::string> RenderedFinger::take_message() {
  if (notices_told_ < notices_.size()) {
    const DeviceNotice& notice = notices_[notices_told_++];
    return notice.key + ": " + notice.text;
  }
  if (!chain_.has_device()) return std::nullopt;
  const auto event = chain_.device().actuator().take_event();
  return event ? std::optional(chain_.device().actuator().message(*event)) : std::nullopt;
}

void RenderedFinger::hand_over(const std::optional<Pose>& X_WFt, double time) {
  const bool valid = X_WFt && X_WFt->translation.allFinite() && X_WFt->rotation.allFinite();
  handed_ = {.time = time, .X_WFt = valid ? *X_WFt : from_, .valid = valid};
  target_ = conditioned_->sample(time);
  // Nobody was anywhere before the first pose.
  if (!seen_) from_ = target_.X_WFt;
  seen_ = seen_ || target_.valid;
}

TrackedInput RenderedFinger::on_the_way(std::int64_t step, std::int64_t count, double time) const {
  TrackedPose tracked = target_;
  tracked.time = time;
  if (step < count) {
    const double fraction = static_cast<double>(step) / static_cast<double>(count);
    tracked.X_WFt = interpolate(from_, target_.X_WFt, fraction);
  }
  return TrackedInput(tracked);
}

const TickRecord& RenderedFinger::tick(std::chrono::steady_clock::time_point arrival,
                                       double origin) {
  const TickRecord& tick = chain_.tick(chain_.tick_input(arrival));
  command_.tick = tick.tick;
  command_.time = origin + tick.time;
  command_.configuration = tick.command.configuration;
  command_.joints = tick.command.joints;
  for (Eigen::Index i = 0; i < command_.set_points.size() && i < tick.command.servos; ++i) {
    command_.set_points[i] = tick.command.targets[static_cast<std::size_t>(i)] * servo_step_;
  }
  command_.pulse_widths = command_.set_points;
  command_.deviation = tick.deviation;
  command_.state = state_name(tick.command.state);
  return tick;
}

void RenderedFinger::tell_stops() {
  if (!chain_.has_device()) return;
  const StopLatch& latch = chain_.device().actuator().stop_latch();
  command_.stops = latch.newest();
  command_.stopped = latch.is_stopped();
  command_.stop_confirmed = command_.stopped && latch.confirmed() == command_.stops;
}

}  // namespace softfinger
