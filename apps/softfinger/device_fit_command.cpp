#include "device_fit_command.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "guard_option.hpp"
#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/sensing/force_sensor_emulator.hpp"
#include "softfinger/session/device_fit.hpp"
#include "softfinger/session/report/device_fit_report.hpp"
#include "stop_signal.hpp"

namespace {

using namespace softfinger;

struct DeviceFitFlags {
  std::string device, finger, person, wearer, sensor, fault;
  std::string name = "index";
  std::optional<double> sensor_noise_N;
  std::uint64_t seed = 1;
  double fault_at_s = 0.0;
  bool again = false;
  bool by_touch = false;
  bool real_time = false;
  bool json = false;
};

/// Whether Enter was pressed since the last time; false for ever where input has ended.
bool enter_was_pressed() {
  bool pressed = false;
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  while (poll(&input, 1, 0) > 0 && (input.revents & POLLIN) != 0) {
    char c = 0;
    if (read(STDIN_FILENO, &c, 1) <= 0) break;
    pressed = pressed || c == '\n';
  }
  return pressed;
}

DeviceFitOptions options_of(const DeviceFitFlags& flags) {
  DeviceFitOptions options;
  options.device = flags.device;
  options.finger = flags.finger;
  options.person = flags.person;
  options.name = flags.name;
  if (!flags.wearer.empty()) options.wearer = flags.wearer;
  if (!flags.sensor.empty()) options.sensor = row_named(kForceSensorKinds, flags.sensor)->value;
  options.sensor_noise = flags.sensor_noise_N;
  options.seed = flags.seed;
  options.again = flags.again;
  options.by_touch = flags.by_touch;
  if (flags.by_touch) options.told = enter_was_pressed;
  options.real_time = flags.real_time;
  options.guard_program = guard_program();
  if (!flags.fault.empty()) options.fault = row_named(kForceSensorFaults, flags.fault)->value;
  options.fault_at = flags.fault_at_s;
  return options;
}

void print(const DeviceFit& fit, const DeviceFitFlags& flags) {
  if (fit.by_touch) {
    fmt::print("{} touches in {:.1f} s, {:.2f} mm off those of the finger found\n", fit.presses,
               fit.duration, fit.estimate.touch_deviation / mm);
  } else {
    fmt::print("{} presses in {:.1f} s, greatest force {:.2f} N, noise of the sensor {:.3f} N\n",
               fit.presses, fit.duration, fit.greatest_force, fit.noise);
  }
  std::vector<std::string_view> untold;
  for (const DeviceFit::Told& told : fit.traits) {
    const WearerTraitRow& row = row_of(kWearerTraitRows, told.trait);
    fmt::print("{:<17} {:>7.2f}   95 %: {:.2f} to {:.2f}   before: {:.2f}\n", row.name,
               told.value / row.unit, told.ci95_low / row.unit, told.ci95_high / row.unit,
               told.prior / row.unit);
    if (!fit.estimate.is_told(told.trait)) untold.push_back(row.name);
  }
  if (!untold.empty()) {
    fmt::print("no better known than before: {}\n", fmt::join(untold, ", "));
  }
  if (fit.by_touch) {
    fmt::print(
        "the force of a light press is foretold to some {:.0f} %, of the model as it was to {:.0f} "
        "%: touches do not tell how stiff skin is, a [force_sensor] does\n",
        100.0 * fit.estimate.predicted_force_error, 100.0 * fit.estimate.known_force_error);
  } else {
    fmt::print("the model as it was is {:.0f} % off the force of a press\n",
               100.0 * fit.estimate.known_force_error);
    fmt::print("each press is foretold by the others to {:.1f} % of its force\n",
               100.0 * fit.estimate.predicted_force_error);
  }
  if (const std::string told = told_of_registration(fit); !told.empty()) fmt::print("{}\n", told);
  fmt::print("wrote {}, finger {}\n", fit.written.string(), flags.name);
}

void fit(const DeviceFitFlags& flags) {
  DeviceFitOptions options = options_of(flags);
  const std::atomic<bool>& stop = stop_on_signals();
  options.stop_signals = &stop_devices_on_signals();
  ProgressBar bar;
  RunObserver observer;
  observer.message = [&bar](const std::string& message) {
    bar.clear();
    fmt::print(stderr, "softfinger: {}\n", message);
  };
  observer.progress = [&bar](double part, std::optional<double> end) {
    bar.show(part / end.value_or(1.0));
  };
  const DeviceFit found = fit_device(options, stop, observer);
  bar.clear();
  if (flags.json) fmt::print("{}\n", device_fit_report(found).dump(2));
  if (!found.failure.empty()) {
    throw OperationError(fmt::format("device fit: {}; nothing written", found.failure));
  }
  if (!flags.json) print(found, flags);
}

}  // namespace

void add_device_fit_action(CLI::App& device) {
  CLI::App* command = device.add_subcommand(
      "fit", "The device learns its wearer: presses by itself, and writes what finger it sits on");
  auto flags = std::make_shared<DeviceFitFlags>();
  takes_shipped(
      command->add_option("DEVICE", flags->device, "Device file, or the name of a shipped one"),
      Shipped::kDevice)
      ->required();
  takes_shipped(
      command->add_option("--finger", flags->finger, "finger file whose shape and skin are fitted"),
      Shipped::kFinger)
      ->required();
  command->add_option("--person", flags->person, "person file to write or change")->required();
  command->add_option("--name", flags->name, "of the finger in it")->capture_default_str();
  takes_shipped(command->add_option("--wearer", flags->wearer,
                                    "finger file of whom an emulated device is on; --finger where "
                                    "not given"),
                Shipped::kFinger);
  command
      ->add_option("--sensor", flags->sensor,
                   fmt::format("an emulated force sensor for a device file that has none: {}",
                               listed(names_of(kForceSensorKinds), "or")))
      ->check(CLI::IsMember(names_of(kForceSensorKinds)));
  command->add_option("--sensor-noise-N", flags->sensor_noise_N,
                      "of an emulated sensor, standard deviation, instead of the file's");
  command->add_option("--seed", flags->seed, "of that noise")->capture_default_str();
  command->add_flag("--again", flags->again,
                    "the finger is known, the device was put on again: five presses, mount alone");
  command->add_flag("--by-touch", flags->by_touch,
                    "without a force sensor: the wearer presses Enter at each touch; an emulated "
                    "wearer tells by itself");
  command->add_flag("--real-time", flags->real_time,
                    "an emulated device too goes by the clock, through port and guard process");
  command
      ->add_option("--fault", flags->fault,
                   fmt::format("of an emulated sensor, to see what is made of it: {}",
                               listed(names_of(kForceSensorFaults), "or")))
      ->check(CLI::IsMember(names_of(kForceSensorFaults)));
  command->add_option("--fault-at-s", flags->fault_at_s, "when that begins, s")
      ->capture_default_str();
  command->add_flag("--json", flags->json, "one JSON object on stdout");
  command->callback([flags] { fit(*flags); });
}
