#include "softfinger/session/device_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/person/person_registration.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/session/kept_ceiling.hpp"
#include "softfinger/session/pressing_device.hpp"
#include "softfinger/session/worn_device.hpp"
#include "softfinger/wearer/advance.hpp"
#include "softfinger/wearer/press_relaxation.hpp"
#include "softfinger/wearer/touch_procedure.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr double kDepth = 1.5 * mm;       // beyond the resting skin, that every press must reach
constexpr double kTouchDepth = 0.5 * mm;  // the same of a touch
constexpr double kCi95 = 1.959963985;     // standard deviations

/// None where a wearer tells touches.
std::optional<ForceSensorSettings> sensor_of(const DeviceFitOptions& options,
                                             const Device& device) {
  if (options.by_touch) {
    if (!has_motors(device)) return ForceSensorSettings{};
    if (options.told) return std::nullopt;
    throw InputError(fmt::format("{}: it has motors, and nobody to tell where they touch",
                                 options.device.string()));
  }
  std::optional<ForceSensorSettings> sensor = device.settings().force_sensor;
  if (!sensor && options.sensor) {
    sensor.emplace();
    sensor->kind = *options.sensor;
  }
  if (sensor) {
    if (options.sensor_noise) sensor->noise = *options.sensor_noise;
    return *sensor;
  }
  ConfigFile(options.device)
      .root()
      .fail("force_sensor",
            "missing; a device learns its wearer by the force that it measures, "
            "give it a [force_sensor], try one by --sensor, or tell each touch by --by-touch");
}

/// The limit of force of skin that is further off by as much as the presses look for it. That of
/// the model's skin would keep the device off a finger that is smaller; what is measured is the
/// limit.
std::shared_ptr<const TravelCeiling> further_ceiling(const FingerModel& finger,
                                                     const Device& device, double further) {
  const double max_force = device.settings().max_force;
  if (!(max_force > 0.0)) return nullptr;
  const Vector3 away = -further * device.settings().X_FB.rotation.col(2);
  return std::make_shared<TravelCeiling>(
      kept_force_ceiling(finger, device.mounted({Matrix3::Identity(), away}), max_force));
}

/// What is known before: of a device that is put on again what was found; else sizes that were
/// measured.
TraitVector known_traits(const PersonFinger* person, const FingerModel& finger, bool again) {
  TraitVector known = TraitVector::Zero();
  if (person == nullptr) return known;
  const FingerSize own = finger_size(finger);
  const auto put = [&](WearerTrait trait, double value) {
    const auto i = static_cast<Eigen::Index>(trait);
    known[i] = value / kWearerTraitRows[static_cast<std::size_t>(trait)].deviation;
  };
  const auto put_size = [&](WearerTrait trait, const std::optional<double>& size, double of_file) {
    if (size) put(trait, std::log(*size / of_file));
  };
  if (again || !person->mount) {
    put_size(WearerTrait::kLength, person->size.length, *own.length);
    put_size(WearerTrait::kBreadth, person->size.breadth, *own.breadth);
    put_size(WearerTrait::kDepth, person->size.depth, *own.depth);
  }
  if (again) put(WearerTrait::kModulus, std::log(person->modulus_factor.value_or(1.0)));
  return known;
}

void tell(const WearerEstimate& estimate, const TraitVector& known, const FingerModel& finger,
          DeviceFit& fit) {
  for (const WearerTraitRow& row : kWearerTraitRows) {
    const auto i = static_cast<Eigen::Index>(row.value);
    const double half = kCi95 * estimate.deviation[i];
    fit.traits.push_back({row.value, trait_value(row.value, estimate.x[i], finger),
                          trait_value(row.value, estimate.x[i] - half, finger),
                          trait_value(row.value, estimate.x[i] + half, finger),
                          trait_value(row.value, known[i], finger)});
  }
}

void put(const WearerEstimate& estimate, const FingerModel& finger, PersonFinger& person) {
  const WearerTraits traits = WearerTraits::of(estimate.x);
  const FingerSize own = finger_size(finger);
  person.size = {.length = *own.length * traits.size_factor.x(),
                 .breadth = *own.breadth * traits.size_factor.y(),
                 .depth = *own.depth * traits.size_factor.z()};
  person.modulus_factor = traits.modulus_factor;
  person.mount = traits.mount_fit();
}

/// How far two touches of one tilt are apart, m.
double apart(const Device& device, const TouchRecord& a, const TouchRecord& b) {
  return std::sqrt(device.squared_distance(advanced(device, a.start, a.advance),
                                           advanced(device, b.start, b.advance)));
}

/// To writing what was found; empty: none.
std::string objection(const DeviceFit& fit, const fs::path& finger) {
  if (fit.by_touch) {
    if (fit.apart > kMostApart) {
      return fmt::format(
          "the same touch was told {:.1f} mm apart, at the beginning and in the end, at most {:g} "
          "mm would do: tell each as soon as it is felt, and hold still",
          fit.apart / mm, kMostApart / mm);
    }
    if (fit.estimate.touch_deviation <= kMostTouchDeviation) return {};
    return fmt::format(
        "touches are {:.2f} mm off those of the finger found, at most {:g} mm would do: they were "
        "told too early or late, or the wearer did not hold still",
        fit.estimate.touch_deviation / mm, kMostTouchDeviation / mm);
  }
  if (fit.estimate.predicted_force_error <= kMostForetoldError) return {};
  return fmt::format(
      "the force of each press is {:.0f} % off what the others foretell, at most {:.0f} % would "
      "do: the wearer did not hold still, or the finger is unlike {}",
      100.0 * fit.estimate.predicted_force_error, 100.0 * kMostForetoldError, finger.string());
}

void check(const DeviceFitOptions& options) {
  if (!is_finger_name(options.name)) {
    throw InputError(fmt::format(
        "--name {}: no name of a finger; expected 1 to 64 letters, digits, - or _", options.name));
  }
  if (options.by_touch &&
      (options.sensor || options.sensor_noise || options.fault != ForceSensorFault::kNone)) {
    throw InputError(
        "--by-touch: asks the wearer and no force sensor; leave --sensor, --sensor-noise-N and "
        "--fault out");
  }
  constexpr double kMostNoise = 10.0;  // N
  const auto& noise = options.sensor_noise;
  if (noise && !(*noise >= 0.0 && *noise <= kMostNoise)) {
    throw InputError(fmt::format("--sensor-noise-N {}: must be 0 to {:g} N", *noise, kMostNoise));
  }
  if (!(options.fault_at >= 0.0 && std::isfinite(options.fault_at))) {
    throw InputError(
        fmt::format("--fault-at-s {}: must be a time from 0 in seconds", options.fault_at));
  }
}

/// Why nothing would run with what was found; empty: it can be worn.
std::string why_not_worn(const DeviceFitOptions& options, const FingerModel& finger,
                         const PersonFinger& found) {
  try {
    const auto fitted =
        FingerModel::load(options.finger, found.size, found.modulus_factor.value_or(1.0));
    (void)fitted_without_ceiling(*fitted, finger, options.device, *found.mount);
    return {};
  } catch (const InputError& error) {
    return fmt::format("on the finger that was found it cannot be worn: {}", error.what());
  }
}

/// Where the tracked body sits follows the size.
void follow_registration(PersonFinger& finger, const std::filesystem::path& model, DeviceFit& fit) {
  const std::optional<Pose> before = finger.X_BodyFt;
  try {
    fit.registration = register_again(finger, model);
  } catch (const InputError& error) {
    fit.registration_failure = error.what();
    return;
  }
  if (!fit.registration || !before) return;
  fit.registration_moved = (fit.registration->X_BodyFt.translation - before->translation).norm();
}

}  // namespace

std::string told_of_registration(const DeviceFit& fit) {
  if (!fit.registration_failure.empty()) {
    return "where the tracked body sits stays as it was: " + fit.registration_failure;
  }
  if (!fit.registration) return {};
  return fmt::format(
      "the tracked body sits {:.2f} mm from where it was thought to; by that the skin lay within "
      "{:.2f} mm of the table",
      fit.registration_moved / mm, fit.registration->height_residual / mm);
}

DeviceFit fit_device(const DeviceFitOptions& options, const std::atomic<bool>& stop,
                     const RunObserver& observer) {
  check(options);
  // One that comes while files are read counts.
  const std::uint32_t stops =
      options.stop_signals != nullptr ? options.stop_signals->stops.load() : 0;
  const auto finger = FingerModel::load(options.finger);
  const auto wearer = options.wearer ? FingerModel::load(*options.wearer) : finger;
  // Before anybody is pressed.
  Person person = load_person_if_any(options.person);
  const PersonFinger* before = person.find(options.name);
  if (options.again && (before == nullptr || !before->mount)) {
    throw InputError(fmt::format("{}: finger {} was never fitted; leave --again out",
                                 options.person.string(), options.name));
  }
  WornDevice worn = worn_on(*finger, options.device);
  worn.ceiling = further_ceiling(
      *finger, *worn.device, options.by_touch ? TouchLimits{}.past : PressProcedure::kFurthestPast);
  const std::optional<ForceSensorSettings> sensor = sensor_of(options, *worn.device);
  std::vector<PlannedPress> plan;
  try {
    plan = plan_presses(*worn.device, *finger, options.by_touch ? kTouchDepth : kDepth);
  } catch (const InputError& error) {
    throw OperationError(fmt::format("{}: {}", options.device.string(), error.what()));
  }
  // The first, straight on, once more in the end: a wearer who tells it elsewhere tells nothing;
  // and where there is time for a press its readings count most, but for one that nothing else
  // tells of.
  if (options.by_touch || plan.size() > 1) {
    plan.push_back(plan.front());
    plan.back().spare = !options.by_touch;
  }
  if (options.again) {
    std::erase_if(plan, [](const PlannedPress& press) { return press.spare; });
  }

  DeviceFit fit;
  const TraitVector known = known_traits(before, *finger, options.again);
  fit.by_touch = options.by_touch;
  PressingDevice pressing(options, worn, wearer, sensor, stops);
  const double tick = 1.0 / pressing.rate();
  const auto take = [&](auto& procedure) {
    pressing.run(procedure, static_cast<int>(plan.size()), stop, observer);
    fit.failure = pressing.interruption().empty() ? procedure.failure() : pressing.interruption();
    fit.greatest_force = pressing.greatest_true_force();
    fit.duration = procedure.duration();
  };
  std::vector<PressRecord> presses;
  std::vector<TouchRecord> touches;
  if (options.by_touch) {
    TouchProcedure procedure(*worn.device, plan, tick);
    take(procedure);
    touches = procedure.touches();
    fit.presses = static_cast<int>(touches.size());
    if (fit.failure.empty()) fit.apart = apart(*worn.device, touches.front(), touches.back());
  } else {
    PressLimits limits;
    // Within ten seconds: where the mount is, any press tells.
    if (options.again) limits.straight_press = limits.press;
    PressProcedure procedure(*worn.device, plan, tick, limits);
    take(procedure);
    presses = procedure.presses();
    fit.presses = static_cast<int>(presses.size());
    fit.noise = procedure.noise();
    fit.delay = procedure.delay();
    // An emulated wearer knows better than the sensor.
    if (!(fit.greatest_force > 0.0)) fit.greatest_force = procedure.greatest_force();
  }
  if (!fit.failure.empty()) return fit;

  // The model that is pressed does not relax.
  presses = without_relaxation(std::move(presses), finger->relaxation);
  // Neither where it is touched: what is known and what is told are of a wearer in use.
  TraitVector in_use = TraitVector::Zero();
  if (options.by_touch) {
    const auto modulus = static_cast<Eigen::Index>(WearerTrait::kModulus);
    in_use[modulus] = std::log(stiffness_in_use(*finger, PressLimits{}.press)) /
                      kWearerTraitRows[static_cast<std::size_t>(modulus)].deviation;
  }
  PressModel model(finger, worn.device, finger->friction_coefficient);
  const WearerEstimateOptions how{.noise = fit.noise,
                                  .mount_only = options.again,
                                  .known = known - in_use,
                                  .progress = [&](double fraction) {
                                    if (options.watch)
                                      options.watch({.estimating = true, .progress = fraction});
                                    // A stop that finds the device retracted is one too.
                                    const bool stopped =
                                        options.stop_signals != nullptr &&
                                        options.stop_signals->stops.load() != stops;
                                    return !stop.load() && !stopped;
                                  }};
  try {
    fit.estimate = options.by_touch ? estimate_wearer(model, touches, how)
                                    : estimate_wearer(model, presses, how);
  } catch (const OperationError& error) {
    fit.failure = error.what();
    return fit;
  }
  fit.estimate.x += in_use;
  tell(fit.estimate, known, *finger, fit);
  fit.failure = objection(fit, options.finger);
  if (!fit.failure.empty()) return fit;
  PersonFinger& found = person.at(options.name);
  put(fit.estimate, *finger, found);
  fit.failure = why_not_worn(options, *finger, found);
  if (!fit.failure.empty()) return fit;
  if (!options.again) follow_registration(found, options.finger, fit);
  save_person(person);
  fit.written = options.person;
  return fit;
}

}  // namespace softfinger
