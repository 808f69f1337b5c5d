#include "calibrate_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/actuation/servo_calibration.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/device/transport_text.hpp"

using namespace softfinger;

namespace {

struct CalibrateFlags {
  std::string device, out, port;
  std::vector<double> at, moved;
};

/// A number that a person types; asks again until it is one.
double ask_number(const std::string& question) {
  while (true) {
    fmt::print(stderr, "{} ", question);
    std::string line;
    if (!std::getline(std::cin, line)) {
      throw InputError(
          "calibrate: no answer on the standard input; answer, or give --at and --moved");
    }
    double value = 0.0;
    if (CLI::detail::lexical_cast(line, value) && std::isfinite(value)) return value;
    fmt::print(stderr, "That is no number.\n");
  }
}

void check_answers(const CalibrateFlags& flags, int servos) {
  const auto count = static_cast<std::size_t>(servos);
  if (flags.at.empty() && flags.moved.empty()) return;
  if (flags.at.size() != count || flags.moved.size() != count) {
    throw InputError(fmt::format("--at and --moved: need {} numbers each, one a servo", servos));
  }
  const auto finite = [](const std::vector<double>& numbers) {
    return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
  };
  if (!finite(flags.at) || !finite(flags.moved)) {
    throw InputError("--at and --moved: must be finite numbers");
  }
}

void calibrate(const CalibrateFlags& flags) {
  if (std::filesystem::exists(flags.out)) {
    throw InputError(fmt::format("{} exists; name a new file", flags.out));
  }
  const auto device = load_device(flags.device);
  ServoCalibration calibration(device, flags.port);
  check_answers(flags, calibration.servos());
  const JointLimits& limits = device->joint_limits();
  const double unit = limits.linear ? mm : deg;
  const std::string_view unit_name = limits.linear ? "mm" : "degrees";

  TransportSettings result = device->settings().transport.value();
  std::string remarks;
  for (int i = 0; i < calibration.servos(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    ServoSighting seen;
    seen.at =
        unit *
        (flags.at.empty()
             ? ask_number(fmt::format("Joint {} should stand at {:.1f} {}. Where does it stand?",
                                      i + 1, calibration.home(i) / unit, unit_name))
             : flags.at[at]);
    seen.told = calibration.move_away(i);
    seen.moved = unit * (flags.moved.empty()
                             ? ask_number(fmt::format(
                                   "Joint {} should have moved by {:+.1f} {}. By how many did it?",
                                   i + 1, seen.told / unit, unit_name))
                             : flags.moved[at]);
    calibration.move_back();
    try {
      result.servos[at] = calibration.calibrated_servo(i, seen);
    } catch (const InputError& error) {
      throw InputError(fmt::format("joint {}: {}", i + 1, error.what()));
    }
    const JointRange range = joint_range(result.servos[at]);
    remarks += fmt::format("# joint {} reaches {:.1f} to {:.1f} {}\n", i + 1, range.min / unit,
                           range.max / unit, unit_name);
  }
  std::ofstream file(flags.out);
  file << "# Servos as calibrated; take this in place of [transport] in " << flags.device << ".\n"
       << remarks << transport_text(result, limits.linear);
  file.close();
  if (!file) throw OperationError(fmt::format("{} cannot be written", flags.out));
  fmt::print("{}wrote {}\n", remarks, flags.out);
}

}  // namespace

void add_calibrate_action(CLI::App& device_command) {
  auto flags = std::make_shared<CalibrateFlags>();
  CLI::App* action = device_command.add_subcommand(
      "calibrate", "Finds direction, offset and range of each servo, moving it slowly");
  action->add_option("DEVICE", flags->device, "Device file")->required();
  action->add_option("--out", flags->out, "New file for the servos' section")->required();
  action->add_option("--port", flags->port, "Instead of the file's");
  action
      ->add_option("--at", flags->at,
                   "Where each joint stands at home, a,b,c in degrees or mm, instead of asking")
      ->delimiter(',');
  action
      ->add_option("--moved", flags->moved,
                   "How far each joint moved, a,b,c in degrees or mm, instead of asking")
      ->delimiter(',');
  action->callback([flags] { calibrate(*flags); });
}
