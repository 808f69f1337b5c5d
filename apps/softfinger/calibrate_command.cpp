#include "calibrate_command.hpp"

#include <fmt/core.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "calibrate_sensor.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/session/servo_calibration_file.hpp"
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

void calibrate(const CalibrateFlags& flags) {
  if (!flags.sensor_g.empty()) {
    if (std::filesystem::exists(flags.out)) {
      throw InputError(fmt::format("{} exists; name a new file", flags.out));
    }
    calibrate_sensor(flags.device, flags.sensor_g, flags.out);
    return;
  }
  const std::atomic<bool>& stop = stop_on_signals();
  ServoCalibrationOptions options{.device = flags.device, .out = flags.out, .port = flags.port};
  options.at = flags.at;
  options.moved = flags.moved;
  options.ask_at = [&stop](int joint, double expected, const char* unit) {
    return ask_number(fmt::format("Joint {} should stand at {:.1f} {}. Where does it stand?", joint,
                                  expected, unit),
                      stop);
  };
  options.ask_moved = [&stop](int joint, double told, const char* unit) {
    return ask_number(fmt::format("Joint {} should have moved by {:+.1f} {}. By how many did it?",
                                  joint, told, unit),
                      stop);
  };
  const std::string remarks = calibrate_servos(options, stop);
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
