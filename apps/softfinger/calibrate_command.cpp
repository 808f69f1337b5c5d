#include "calibrate_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibrate_sensor.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/device/servo_calibration.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/transport_file.hpp"
#include "softfinger/motors/transport_text.hpp"
#include "stop_signal.hpp"

using namespace softfinger;

namespace {

struct CalibrateFlags {
  std::string device, out, port;
  std::vector<double> at, moved, sensor_g;
};

/// A number that a person types; asks again until it is one.
double ask_number(const std::string& question, const std::atomic<bool>& stop) {
  while (true) {
    fmt::print(stderr, "{} ", question);
    std::string line;
    const bool answered = static_cast<bool>(std::getline(std::cin, line));
    if (stop.load()) throw OperationError("calibrate: ended before it was done; nothing written");
    if (!answered) {
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

/// What the section would be refused for when it is read again.
void check_cover(const CalibrateFlags& flags, const TransportSettings& found,
                 const JointLimits& limits) {
  const double unit = limits.linear ? mm : deg;
  double least = limits.min.maxCoeff();
  double largest = limits.max.minCoeff();
  double missing = 0.0;  // set points, in the unit of the file
  int worst = 0;
  for (std::size_t i = 0; i < found.servos.size(); ++i) {
    const ServoSettings& servo = found.servos[i];
    const auto joint = static_cast<Eigen::Index>(i);
    const JointRange range = joint_range(servo);
    least = std::max(least, range.min);
    largest = std::min(largest, range.max);
    const double beyond = std::max(range.min - limits.min[joint], limits.max[joint] - range.max) *
                          std::abs(servo.per_radian) / found.unit_scale;
    if (beyond > missing) {
      missing = beyond;
      worst = static_cast<int>(i) + 1;
    }
  }
  constexpr double kRounding = 1e-4;
  if (missing > kRounding) {
    const std::string narrower = least < largest
                                     ? fmt::format("narrow the joints' limits to [{:.1f}, {:.1f}]",
                                                   std::ceil(least / unit * 10.0) / 10.0,
                                                   std::floor(largest / unit * 10.0) / 10.0)
                                     : std::string("look again where it stands");
    throw InputError(fmt::format(
        "{}: not written: joint {} does not reach its limits with the set points allowed; widen "
        "them by {:.0f} {}, put its horn on anew, or {}, in {}",
        flags.out, worst, std::ceil(missing), found.unit.empty() ? "(its unit)" : found.unit,
        narrower, flags.device));
  }
  try {
    const ConfigFile again(flags.out, transport_text(found, limits.linear));
    (void)read_transport(again.root().table("transport"), limits);
  } catch (const InputError& error) {
    throw InputError(fmt::format("not written, a device could not have it: {}", error.what()));
  }
}

void calibrate(const CalibrateFlags& flags) {
  if (std::filesystem::exists(flags.out)) {
    throw InputError(fmt::format("{} exists; name a new file", flags.out));
  }
  if (!flags.sensor_g.empty()) {
    calibrate_sensor(flags.device, flags.sensor_g, flags.out);
    return;
  }
  const auto device = load_device(flags.device);
  const std::atomic<bool>& stop = stop_on_signals();
  ServoCalibration calibration(device, flags.port, stop);
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
                                      i + 1, calibration.home(i) / unit, unit_name),
                          stop)
             : flags.at[at]);
    seen.told = calibration.move_away(i);
    seen.moved =
        unit *
        (flags.moved.empty()
             ? ask_number(
                   fmt::format("Joint {} should have moved by {:+.1f} {}. By how many did it?",
                               i + 1, seen.told / unit, unit_name),
                   stop)
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
  check_cover(flags, result, limits);
  std::ofstream file(flags.out);
  file << "# Servos as calibrated; take this in place of [transport] in " << flags.device << ".\n"
       << remarks << transport_text(result, limits.linear);
  file.close();
  if (!file) {
    std::error_code ignored;
    std::filesystem::remove(flags.out, ignored);
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", flags.out));
  }
  fmt::print("{}wrote {}\n", remarks, flags.out);
}

}  // namespace

void add_calibrate_action(CLI::App& device_command) {
  auto flags = std::make_shared<CalibrateFlags>();
  CLI::App* action = device_command.add_subcommand(
      "calibrate", "Finds direction, offset and range of each servo, moving it slowly");
  takes_shipped(
      action->add_option("DEVICE", flags->device, "Device file, or the name of a shipped one"),
      Shipped::kDevice)
      ->required();
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
  action
      ->add_option("--sensor-g", flags->sensor_g,
                   "Instead of the servos the force sensor, under these weights, 0,50,100 in g")
      ->delimiter(',');
  action->callback([flags] { calibrate(*flags); });
}
