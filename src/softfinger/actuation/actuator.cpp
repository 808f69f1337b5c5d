#include "softfinger/actuation/actuator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>
#include <utility>
#include <vector>

#include "softfinger/actuation/guard_process.hpp"
#include "softfinger/actuation/line_thread.hpp"
#include "softfinger/actuation/motion_guard.hpp"
#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/emulation/emulated_bus.hpp"
#include "softfinger/motors/motor_kinds.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

constexpr std::string_view kEmulator = "emulator";
constexpr double kDefaultRate = 30.0;
/// Emulated servos are somewhat faster than they are asked to be, as real ones are chosen.
constexpr double kServoReserve = 1.25;
/// Of emulated devices that follow the travel, m/s.
constexpr double kFastestTravel = 0.1;

/// Of what servos follow, a second.
double largest_rate(const Device& device) {
  return device.settings().transport->follows_travel ? kFastestTravel
                                                     : device.joint_limits().max_rate;
}

/// What the one servo of a device follows that follows the travel.
JointAngles travel_of_home(const Device& device) {
  return JointAngles::Constant(1, device.home()[device.approach_axis()]);
}

std::vector<EmulatedServo> emulated_servos(const Device& device) {
  JointAngles home;
  if (!device.inverse_kinematics(device.home(), home)) device.clamped_joints(device.home(), home);
  std::vector<EmulatedServo> servos;
  if (device.settings().transport->follows_travel) home = travel_of_home(device);
  Eigen::Index joint = 0;
  for (const ServoSettings& settings : device.settings().transport->servos) {
    servos.push_back({.channel = settings.channel,
                      .initial_setpoint = ServoMap(settings).setpoint(home[joint++]),
                      .rate = kServoReserve * largest_rate(device) * std::abs(settings.per_radian),
                      .step = settings.step});
  }
  return servos;
}

void check_servos(const Device& device) {
  const TransportSettings& transport = *device.settings().transport;
  if (transport.follows_travel) {
    const int axis = device.approach_axis();
    if (axis < 0 || device.axes()[static_cast<std::size_t>(axis)].angular) {
      throw InputError(fmt::format(
          "transport.kind: \"{}\" follows a device's travel towards the finger, and this one has "
          "none in mm; use a device that has, such as a platform, or another transport",
          transport.kind));
    }
    return;
  }
  if (static_cast<int>(transport.servos.size()) != device.joint_count() ||
      device.joint_count() > FormedCommand::kMaxServos) {
    throw InputError(fmt::format(
        "transport.servo: {} servos for {} joints; a device needs one for each, at most {}",
        transport.servos.size(), device.joint_count(), FormedCommand::kMaxServos));
  }
}

/// Checked to be what MotionGuard takes.
std::vector<ServoSettings> servo_settings(const Device& device) {
  const auto& transport = device.settings().transport;
  if (!transport) return {};
  check_servos(device);
  return transport->servos;
}

/// Less above the ceiling (m) than this is as good as on it.
constexpr double kForceLimited = 1e-5;
/// A stop is heard in milliseconds; on a machine that is too busy for this it is not.
constexpr std::chrono::milliseconds kStopTestTime{5000};

[[noreturn]] void refuse_port(const ActuatorOptions& options, const std::string& port,
                              const std::string& reason) {
  const std::string line = fmt::format(
      "port {} cannot be opened: {}; connect it, name another, use port = \"emulator\", or give "
      "--wait-for-device",
      port, reason);
  if (options.port.empty() && !options.device_file.empty()) {
    ConfigFile(options.device_file).root().table("transport").fail("port", line);
  }
  throw InputError(line);
}

}  // namespace

struct Actuator::Impl {
  Impl(std::shared_ptr<const Device> the_device, const ActuatorOptions& the_options)
      : device(std::move(the_device)),
        options(the_options),
        guard(device, servo_settings(*device), options.ceiling) {}

  void open();
  void form(const Configuration& goal, double dt);
  void send_to_simulated(double time);

  std::shared_ptr<const Device> device;
  ActuatorOptions options;
  std::string port;
  double period = 1.0 / kDefaultRate;

  MotionGuard guard;
  DeviceStateMachine machine;
  FormedCommand formed;
  double last_time = 0.0;
  bool started = false;
  bool finished = false;

  // One of these carries the commands, none for a device without transport: simulated servos in
  // simulated time, or a line, to an emulator in wall time or to a real port.
  std::unique_ptr<SimulatedServos> simulated;
  std::unique_ptr<EmulatedBus> emulated;
  std::unique_ptr<LineEnd> line;
  std::uint64_t sent_to_simulated = 0;
  StopLatch latch;  ///< without a line, which has its own
  void obey_latch(const WantedMotion& wanted);
  [[nodiscard]] std::string fault_text() const;

  std::string absence;  ///< why the port was not open at the start; empty: it was
  bool absence_told = false;
  /// See MotorKind; empty for an emulator.
  [[nodiscard]] std::string_view left_alone() const;
  bool unwatched_told = false;
  std::uint32_t losses_told = 0;
  std::uint32_t connections_told = 0;
  std::uint32_t stalls_told = 0;
  bool guard_loss_told = false;
  std::uint32_t replacements_told = 0;
  StopLatch::Number stops_told = 0;
  StopLatch::Number releases_told = 0;
  std::uint32_t refusals_told = 0;
};

void Actuator::Impl::open() {
  form(device->home(), 0.0);
  if (!device->settings().transport) return;
  const TransportSettings& transport = *device->settings().transport;
  (void)make_servo_bus(transport);  // refuses what cannot be driven, before a port is opened
  port = options.port.empty() ? transport.port : options.port;
  period = 1.0 / transport.rate;
  std::string line_port = port;
  if (port == kEmulator) {
    if (options.simulated_time) {
      simulated = std::make_unique<SimulatedServos>(emulated_servos(*device));
      return;
    }
    emulated = std::make_unique<EmulatedBus>(transport, emulated_servos(*device));
    line_port = emulated->port();
  }
  const ServoLine::Options line_options{.port = line_port,
                                        .rate = transport.rate,
                                        .unpaced = options.simulated_time,
                                        .ceiling = options.ceiling};
  if (options.guard_program.empty() || options.device_file.empty()) {
    line = std::make_unique<LineThread>(device, line_options);
  } else {
    line = std::make_unique<GuardProcess>(
        options.guard_program, device->home(),
        GuardSetup{.device_file = std::filesystem::absolute(options.device_file),
                   .device_text = device->settings().text,
                   .mount_shift = device->settings().mount_shift,
                   .line = line_options});
  }
  const std::string reason = line->start(options.wait_for_device);
  if (!reason.empty() && !options.wait_for_device) refuse_port(options, port, reason);
  absence = reason;
  if (!line->would_hear_a_stop(kStopTestTime)) {
    throw OperationError(fmt::format(
        "port {}: who leads its servos does not hear a stop; nothing was commanded", port));
  }
}

void Actuator::Impl::form(const Configuration& goal, double dt) {
  guard.step(goal, dt);
  formed.configuration = guard.configuration();
  formed.joints = guard.joints();
  formed.rate_limited = dt > 0.0 && goal.allFinite() && !guard.arrived();
  if (options.ceiling) {
    formed.ceiling = options.ceiling->travel(formed.configuration);
    formed.force_limited = goal.allFinite() && options.ceiling->excess(goal) > kForceLimited;
  }
  const auto targets = guard.targets();
  std::copy(targets.begin(), targets.end(), formed.targets.begin());
  formed.servos = static_cast<int>(targets.size());
}

void Actuator::Impl::send_to_simulated(double time) {
  simulated->advance_to(time);
  simulated->receive(guard.targets());
  ++sent_to_simulated;
}

std::string_view Actuator::Impl::left_alone() const {
  const TransportSettings& transport = *device->settings().transport;
  const MotorKind& kind = motor_kind(transport.kind);
  const bool watched = kind.is_watched != nullptr && kind.is_watched(transport);
  return emulated || watched ? "" : kind.left_alone;
}

std::string Actuator::Impl::fault_text() const {
  const TransportSettings& transport = *device->settings().transport;
  const ServoFaults faults = line->channel().faults.load();
  std::vector<std::string> parts;
  const auto tell = [&](std::uint32_t servos, std::string_view what) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < transport.servos.size(); ++i) {
      if (((servos >> i) & 1U) == 0) continue;
      names.push_back(motor_kind(transport.kind).servo_name(transport.servos[i]));
    }
    if (!names.empty()) parts.push_back(fmt::format("servo {} {}", fmt::join(names, ", "), what));
  };
  tell(faults.silent, "does not answer");
  tell(faults.limp, "has no torque or protects itself");
  tell(line->channel().astray, "is not where it was sent");
  constexpr std::array<std::pair<ServoComplaint, std::string_view>, 5> kComplaints{
      {{kBadVoltage, "says that its voltage is wrong"},
       {kTooHot, "says that it is too hot"},
       {kOverload, "says that it is overloaded"},
       {kDefect, "says that it is defective"},
       {kBadLine, "says that commands came spoilt, in part, or not for too long"}}};
  for (const auto& [complaint, words] : kComplaints) {
    std::uint32_t servos = 0;
    for (std::size_t i = 0; i < transport.servos.size(); ++i) {
      if ((line->channel().complaints[i] & complaint) != 0) servos |= 1U << i;
    }
    tell(servos, words);
  }
  return parts.empty() ? "a servo failed" : fmt::format("{}", fmt::join(parts, ", "));
}

void Actuator::Impl::obey_latch(const WantedMotion& wanted) {
  if (!wanted.emergency || !latch.is_stopped()) return;
  latch.confirm(latch.newest());
  const bool retracted = formed.state == DeviceState::kRetracting && guard.arrived();
  if (latch.release_is_asked()) {
    latch.answer_release(retracted ? ReleaseRefusal::kNone : ReleaseRefusal::kRetracting);
  }
}

Actuator::Actuator(std::shared_ptr<const Device> device, const ActuatorOptions& options)
    : impl_(std::make_unique<Impl>(std::move(device), options)) {
  impl_->open();
}

Actuator::~Actuator() {
  if (impl_) finish();
}

const FormedCommand& Actuator::command(const WantedMotion& wanted, double time) noexcept {
  Impl& self = *impl_;
  if (self.finished) return self.formed;
  const bool later = std::isfinite(time) && (!self.started || time > self.last_time);
  double dt = 0.0;
  if (later) {
    dt = self.started ? std::min(time - self.last_time, self.period) : self.period;
    self.last_time = time;
    self.started = true;
  }

  self.formed.state = self.machine.advance({.time = self.last_time,
                                            .tracked = wanted.tracked,
                                            .touching = wanted.touching,
                                            .emergency = wanted.emergency,
                                            .arrived = self.guard.arrived()});
  switch (self.formed.state) {
    case DeviceState::kRetracting:
      self.form(self.device->retracted(), dt);
      break;
    case DeviceState::kHolding:
      self.form(self.guard.configuration(), dt);
      break;
    default:
      self.form(wanted.configuration, dt);
      break;
  }
  if (self.simulated) self.send_to_simulated(self.last_time);
  if (self.line) {
    self.line->submit(self.formed.configuration, self.formed.state);
  } else {
    self.obey_latch(wanted);
  }
  return self.formed;
}

const FormedCommand& Actuator::last_command() const noexcept { return impl_->formed; }

void Actuator::finish() noexcept {
  Impl& self = *impl_;
  if (self.finished) return;
  self.finished = true;
  if (self.line) {
    self.line->finish();
  } else if (self.started) {
    while (self.formed.state != DeviceState::kStopped) {
      self.last_time += self.period;
      self.formed.state = self.machine.advance(
          {.time = self.last_time, .ending = true, .arrived = self.guard.arrived()});
      if (self.formed.state == DeviceState::kStopped) break;
      self.form(self.device->retracted(), self.period);
      if (self.simulated) self.send_to_simulated(self.last_time);
    }
  }
  self.formed.state = DeviceState::kStopped;
}

StopLatch::Number Actuator::stop(StopCause cause) noexcept {
  return impl_->line ? impl_->line->stop(cause) : impl_->latch.stop(cause);
}

bool Actuator::ask_release(StopLatch::Number number, StopCause by) noexcept {
  return impl_->line ? impl_->line->ask_release(number, by) : impl_->latch.ask_release(number, by);
}

const StopLatch& Actuator::stop_latch() const noexcept {
  return impl_->line ? impl_->line->channel().stop : impl_->latch;
}

bool Actuator::finished() const noexcept { return impl_->finished; }

DeviceState Actuator::state() const noexcept {
  return impl_->line ? *line_state() : impl_->formed.state;
}

std::optional<DeviceState> Actuator::line_state() const noexcept {
  if (!impl_->line) return std::nullopt;
  return impl_->line->channel().state.load(std::memory_order_relaxed);
}

double Actuator::line_silence() const noexcept {
  if (!impl_->line) return std::numeric_limits<double>::quiet_NaN();
  return impl_->line->channel().silence(monotonic_time());
}

bool Actuator::connected() const noexcept {
  return !impl_->line || impl_->line->channel().connected.load(std::memory_order_acquire);
}

bool Actuator::wait_until_connected(std::chrono::milliseconds timeout) const {
  const auto until = std::chrono::steady_clock::now() + timeout;
  while (!connected() && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return connected();
}

std::uint64_t Actuator::commands_sent() const noexcept {
  return impl_->line ? impl_->line->channel().commands_sent.load(std::memory_order_relaxed)
                     : impl_->sent_to_simulated;
}

bool Actuator::read_servo_joints(JointAngles& joints) const noexcept {
  const Impl& self = *impl_;
  if (!self.emulated && !self.simulated) return self.line && self.line->read_joints(joints);
  const auto servos = self.guard.servos();
  const auto setpoint = [&](std::size_t servo) {
    return self.emulated ? self.emulated->emulator().setpoint(servo)
                         : self.simulated->setpoint(servo);
  };
  if (self.device->settings().transport->follows_travel) {
    Configuration q = self.guard.configuration();
    q[self.device->approach_axis()] = servos[0].joint(setpoint(0));
    return self.device->inverse_kinematics(q, joints);
  }
  joints.resize(static_cast<Eigen::Index>(servos.size()));
  for (std::size_t i = 0; i < servos.size(); ++i) {
    joints[static_cast<Eigen::Index>(i)] = servos[i].joint(setpoint(i));
  }
  return true;
}

std::optional<CommandDelivery> Actuator::take_delivery() noexcept {
  return impl_->line ? impl_->line->take_delivery() : std::nullopt;
}

const std::string& Actuator::port() const noexcept { return impl_->port; }

std::optional<ActuatorEvent> Actuator::take_event() noexcept {
  Impl& self = *impl_;
  if (self.line && self.line->replacements() != self.replacements_told) {
    self.replacements_told = self.line->replacements();
    return ActuatorEvent::kGuardReplaced;
  }
  const StopLatch& stop = stop_latch();
  // In the order in which they happen.
  if (stop.newest() != self.stops_told) {
    self.stops_told = stop.newest();
    // That one was told when it came.
    if (stop.cause() != StopCause::kEarlier) return ActuatorEvent::kStopped;
  }
  if (stop.refusals() != self.refusals_told) {
    self.refusals_told = stop.refusals();
    return ActuatorEvent::kReleaseRefused;
  }
  if (stop.released() != self.releases_told) {
    self.releases_told = stop.released();
    return ActuatorEvent::kReleased;
  }
  if (!self.line) return std::nullopt;
  const LineChannel& line = self.line->channel();
  if (!self.absence.empty() && !self.absence_told) {
    self.absence_told = true;
    return ActuatorEvent::kPortAwaited;
  }
  // One event for any number of losses since the last look, and in the order they happen.
  if (line.times_lost != self.losses_told && self.losses_told <= self.connections_told) {
    ++self.losses_told;
    return ActuatorEvent::kPortLost;
  }
  if (line.times_connected != self.connections_told) {
    ++self.connections_told;
    return ActuatorEvent::kPortConnected;
  }
  if (line.times_stalled != self.stalls_told) {
    self.stalls_told = line.times_stalled;
    return ActuatorEvent::kLoopStalled;
  }
  if (!self.guard_loss_told && !self.finished && !self.line->is_served()) {
    self.guard_loss_told = true;
    return ActuatorEvent::kGuardLost;
  }
  if (!self.unwatched_told && !self.left_alone().empty() && connected()) {
    self.unwatched_told = true;
    return ActuatorEvent::kUnwatched;
  }
  return std::nullopt;
}

std::optional<std::string> Actuator::never_opened() const {
  const Impl& self = *impl_;
  if (self.absence.empty() || self.line->channel().times_connected != 0) return std::nullopt;
  return fmt::format("port {} was not to be opened to the end, {}; no command was sent", self.port,
                     self.absence);
}

std::string Actuator::message(ActuatorEvent event) const {
  switch (event) {
    case ActuatorEvent::kPortAwaited:
      return fmt::format("port {} cannot be opened: {}; the run goes on and waits for it",
                         impl_->port, impl_->absence);
    case ActuatorEvent::kPortLost:
      return fmt::format("port {} went away; the run goes on and tries to open it again",
                         impl_->port);
    case ActuatorEvent::kPortConnected:
      return fmt::format("port {} is open", impl_->port);
    case ActuatorEvent::kGuardReplaced:
      return fmt::format(
          "the process that guards port {} died or hung; another one retracts the device",
          impl_->port);
    case ActuatorEvent::kGuardLost:
      return fmt::format(
          "the process that guards port {} has died and cannot be replaced; the device no longer "
          "moves, take it off",
          impl_->port);
    case ActuatorEvent::kStopped:
      if (stop_latch().cause() == StopCause::kServo) {
        const LineChannel& line = impl_->line->channel();
        const bool all = line.faults.load().any() == 0 && line.astray == 0;
        return fmt::format("{}; {} and stay so until the device is released", impl_->fault_text(),
                           all ? "all servos retract" : "the others retract");
      }
      return fmt::format("the device is stopped by {}; it stays retracted until it is released",
                         row_of(kStopCauses, stop_latch().cause()).words);
    case ActuatorEvent::kReleased:
      return fmt::format("the device is released by {}",
                         row_of(kStopCauses, stop_latch().asked_by()).words);
    case ActuatorEvent::kReleaseRefused:
      return fmt::format("the device is not released: {}",
                         row_of(kReleaseRefusals, stop_latch().refusal()).words);
    case ActuatorEvent::kUnwatched:
      return fmt::format("port {}: {}; keep a switch in their supply at hand", impl_->port,
                         impl_->left_alone());
    case ActuatorEvent::kLoopStalled:
      break;
  }
  return fmt::format("no command for {:.0f} ms; the device retracts", kStallTime * 1e3);
}

}  // namespace softfinger
