#include "softfinger/session/live_fit.hpp"

#include <fmt/core.h>

#include <string_view>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/shipped_file.hpp"

namespace softfinger {

namespace {

constexpr std::string_view kTell = "Press Felt, or the space bar, as soon as you feel the device.";

std::string words_of(const DeviceFitMoment& now, bool by_touch) {
  if (by_touch) return std::string(kTell);
  if (now.press == 0) return "Hold still: the sensor's zero is looked for, off the skin.";
  if (now.pitch == 0.0 && now.roll == 0.0) return "Straight.";
  return fmt::format("Turned by {:+.0f} degrees of pitch and {:+.0f} of roll.", now.pitch / deg,
                     now.roll / deg);
}

double value_of(const DeviceFit& found, WearerTrait trait) {
  return found.traits.at(static_cast<std::size_t>(trait)).value;
}

std::string finger_of(const DeviceFit& found) {
  if (found.by_touch) {
    return fmt::format(
        "{:.1f} mm long, {:.1f} mm broad, {:.1f} mm deep; the force of a light press is foretold "
        "to some {:.0f} %, of the model as it was to {:.0f} %: touches do not tell how stiff skin "
        "is",
        value_of(found, WearerTrait::kLength) / mm, value_of(found, WearerTrait::kBreadth) / mm,
        value_of(found, WearerTrait::kDepth) / mm, 100.0 * found.estimate.predicted_force_error,
        100.0 * found.estimate.known_force_error);
  }
  return fmt::format(
      "{:.1f} mm long, {:.1f} mm broad, {:.1f} mm deep, skin {:.2f} times as stiff as the model's; "
      "the model as it was is {:.0f} % off the force of a press, what was learned foretells one "
      "to {:.0f} %",
      value_of(found, WearerTrait::kLength) / mm, value_of(found, WearerTrait::kBreadth) / mm,
      value_of(found, WearerTrait::kDepth) / mm, value_of(found, WearerTrait::kModulus),
      100.0 * found.estimate.known_force_error, 100.0 * found.estimate.predicted_force_error);
}

std::string summary_of(const DeviceFit& found) {
  const std::string registration = told_of_registration(found);
  return finger_of(found) + (registration.empty() ? "" : "; " + registration);
}

}  // namespace

void LiveFit::await(const LiveRequest& request, const RunOptions& options) {
  wanted_ = request;
  ending_.store(false);
  if (options.stop_signals != nullptr) signals_seen_ = options.stop_signals->stops.load();
  const std::lock_guard lock(mutex_);
  state_ = {.phase = FitState::Phase::kWaiting,
            .finger = request.finger,
            .words = "The device retracts before it begins."};
}

bool LiveFit::run(const RunSetup& setup, const RunOptions& options, const std::atomic<bool>& stop,
                  const RunObserver& observer) {
  const SceneFinger& finger = setup.scene.fingers[wanted_.finger];
  DeviceFitOptions fit{.device = *finger.device,
                       .finger = finger.model,
                       .person = setup.person->file,
                       .name = finger.name,
                       .again = wanted_.again,
                       .real_time = true,
                       .guard_program = options.actuator.guard_program,
                       .stop_signals = &stops_};
  fit.by_touch = !setup.devices[wanted_.finger]->settings().force_sensor;
  fit.told = [this] { return told_.exchange(false); };
  told_.store(false);
  {
    const std::lock_guard lock(mutex_);
    state_.by_touch = fit.by_touch;
  }
  if (options.wearer_mount) fit.wear.mount = *options.wearer_mount;
  fit.watch = [&](const DeviceFitMoment& now) {
    if (stop.load()) ending_.store(true);
    if (stopped_by_signal(options)) stop_device();
    watch(now);
  };
  DeviceFit found;
  try {
    if (options.wearer) fit.wearer = file_or_shipped(Shipped::kFinger, options.wearer->native());
    if (ending_.load() || stopped_by_signal(options)) {
      found.failure = "the device was stopped before it began";
    } else {
      found = fit_device(fit, ending_, {.message = observer.message, .progress = {}});
    }
  } catch (const InputError& error) {
    found.failure = error.what();
  } catch (const OperationError& error) {
    found.failure = error.what();
  }
  conclude(found);
  return found.failure.empty();
}

bool LiveFit::stopped_by_signal(const RunOptions& options) {
  if (options.stop_signals == nullptr) return false;
  const std::uint32_t stops = options.stop_signals->stops.load();
  return stops != std::exchange(signals_seen_, stops);
}

void LiveFit::stop_device() {
  stops_.stops.fetch_add(1);
  const std::lock_guard lock(mutex_);
  // Where the device does not press it has no stop to obey, and nothing is to be written all the
  // same.
  if (state_.phase != FitState::Phase::kPressing) ending_.store(true);
}

void LiveFit::watch(const DeviceFitMoment& now) {
  const std::lock_guard lock(mutex_);
  state_.phase = now.estimating ? FitState::Phase::kEstimating : FitState::Phase::kPressing;
  state_.progress = now.progress;
  if (now.estimating) {
    state_.words = "The device has retracted. What finger feels like this is estimated.";
    return;
  }
  state_.press = now.press;
  state_.presses = now.presses;
  state_.words = words_of(now, state_.by_touch);
  state_.force = now.force;
}

void LiveFit::conclude(const DeviceFit& found) {
  const std::lock_guard lock(mutex_);
  state_.phase = found.failure.empty() ? FitState::Phase::kSaved : FitState::Phase::kRefused;
  state_.message = found.failure.empty() ? summary_of(found) : found.failure;
}

void LiveFit::cancel() {
  const std::lock_guard lock(mutex_);
  if (state_.is_under_way()) {
    ending_.store(true);
  } else {
    state_ = {};
  }
}

FitState LiveFit::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

}  // namespace softfinger
