#include "softfinger/session/pressing_device.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/wearer/advance.hpp"

namespace softfinger {
namespace {

constexpr double kAgain = 1.0;      // s, after which an emulated wearer repeats its word
constexpr double kPressing = 0.05;  // N, that is called touching

}  // namespace

bool has_motors(const Device& device) {
  const auto& transport = device.settings().transport;
  return transport && transport->port != "emulator";
}

PressingDevice::PressingDevice(const DeviceFitOptions& options, const WornDevice& worn,
                               std::shared_ptr<const FingerModel> wearer,
                               const std::optional<ForceSensorSettings>& sensor,
                               std::uint32_t stops_seen)
    : options_(options),
      worn_(worn),
      stops_seen_(stops_seen),
      friction_(options.wear.friction_coefficient.value_or(wearer->friction_coefficient)),
      rate_(device_rate(*worn.device)),
      live_(is_live(sensor)),
      actuator_(worn.device, actuator_options()),
      stands_(worn.device->home()),
      really_(stands_),
      late_(static_cast<std::size_t>(options.wear.late), 0.0),
      random_(options.seed) {
  if (!sensor) return;
  sensor_.emplace(std::move(wearer), worn.device->mounted(options.wear.mount),
                  MeasuredForce::Options{.seed = options.seed, .live = live_, .settings = *sensor});
}

template <typename Procedure>
void PressingDevice::press(Procedure& procedure, int presses, const std::atomic<bool>& stop,
                           const RunObserver& observer) {
  const auto began = std::chrono::steady_clock::now();
  const double period = 1.0 / rate_;
  for (std::int64_t tick = 0; !procedure.done() && procedure.failure().empty(); ++tick) {
    const double time = static_cast<double>(tick) * period;
    if (interrupted(stop, observer)) break;
    if (options_.fault != ForceSensorFault::kNone && time >= options_.fault_at) {
      sensor_->fail(options_.fault);
    }
    const FormedCommand& command =
        actuator_.command({.configuration = procedure.wanted(), .touching = touching_}, time);
    if (live_) {
      std::this_thread::sleep_until(began + std::chrono::duration<double>(time + period));
    }
    look(command);
    feel(procedure, time + period);
    if (observer.progress) observer.progress(procedure.progress(), 1.0);
    tell(procedure, presses);
  }
  actuator_.finish();
}

void PressingDevice::run(PressProcedure& procedure, int presses, const std::atomic<bool>& stop,
                         const RunObserver& observer) {
  press(procedure, presses, stop, observer);
}

void PressingDevice::run(TouchProcedure& procedure, int presses, const std::atomic<bool>& stop,
                         const RunObserver& observer) {
  press(procedure, presses, stop, observer);
}

void PressingDevice::feel(PressProcedure& procedure, double time) {
  const bool fresh = measure();
  late_.push_back(options_.wear.gain * measured_);
  said_ = late_.front();
  late_.pop_front();
  touching_ = fresh && said_ > kPressing;
  procedure.advance({.time = time,
                     .stands = stands_,
                     .fresh = fresh,
                     .force = said_,
                     .readings = sensor_->new_readings()});
}

void PressingDevice::feel(TouchProcedure& procedure, double time) {
  const bool told = sensor_ ? emulated_wearer_tells(time) : options_.told();
  procedure.advance({.time = time, .stands = stands_, .told = told});
}

bool PressingDevice::measure() {
  const ForceReading& reading = sensor_->measure(really_, friction_, 1.0 / rate_);
  measured_ = reading.normal_force;
  if (!std::isnan(sensor_->true_force())) {
    greatest_true_ = std::max(greatest_true_, sensor_->true_force());
  }
  return reading.configuration.size() > 0;
}

bool PressingDevice::emulated_wearer_tells(double time) {
  static_cast<void>(measure());
  touching_ = sensor_->true_force() > kFeltForce;
  if (!touching_) {
    tells_at_.reset();
    return false;
  }
  if (!tells_at_) {
    std::normal_distribution<double> takes(options_.wear.reaction, options_.wear.reaction_spread);
    tells_at_ = time + std::max(takes(random_), 0.0);
  }
  if (time < *tells_at_) return false;
  *tells_at_ += kAgain;
  return true;
}

template <typename Procedure>
void PressingDevice::tell(const Procedure& procedure, int presses) const {
  if (!options_.watch) return;
  DeviceFitMoment now{.presses = presses, .force = said_, .progress = procedure.progress()};
  if (const PlannedPress* const press = procedure.under_way()) {
    now.press = static_cast<int>(procedure.number()) + 1;
    now.pitch = press->pitch;
    now.roll = press->roll;
  }
  options_.watch(now);
}

bool PressingDevice::is_live(const std::optional<ForceSensorSettings>& sensor) const {
  return options_.real_time || has_motors(*worn_.device) || (sensor && !sensor->is_emulated());
}

ActuatorOptions PressingDevice::actuator_options() const {
  ActuatorOptions actuator;
  actuator.device_file = options_.device;
  actuator.simulated_time = !live_;
  actuator.ceiling = worn_.ceiling;
  if (live_) actuator.guard_program = options_.guard_program;
  return actuator;
}

bool PressingDevice::interrupted(const std::atomic<bool>& stop, const RunObserver& observer) {
  if (options_.stop_signals != nullptr && options_.stop_signals->stops.load() != stops_seen_) {
    actuator_.stop(StopCause::kSignal);
  }
  while (const auto event = actuator_.take_event()) {
    if (*event == ActuatorEvent::kUnwatched || *event == ActuatorEvent::kPortConnected) {
      if (observer.message) observer.message(actuator_.message(*event));
      continue;
    }
    if (interruption_.empty()) interruption_ = actuator_.message(*event);
  }
  if (stop.load() && interruption_.empty()) interruption_ = "ended before it was done";
  if (actuator_.stop_latch().is_stopped() && interruption_.empty()) {
    interruption_ = "the device is stopped";
  }
  return !interruption_.empty();
}

void PressingDevice::look(const FormedCommand& command) {
  JointAngles joints;
  if (!actuator_.read_servo_joints(joints)) {
    stands_ = command.configuration;
  } else if (Configuration q; worn_.device->forward_kinematics(joints, q)) {
    stands_ = q;
  }
  really_ = stands_;
  // Play is taken up by whoever is behind.
  const double advance =
      advance_between(*worn_.device, Configuration::Zero(stands_.size()), stands_);
  const double half = 0.5 * options_.wear.backlash;
  followed_ = std::clamp(followed_, advance - half, advance + half);
  worn_.device->advance(followed_ - advance, really_);
}

}  // namespace softfinger
