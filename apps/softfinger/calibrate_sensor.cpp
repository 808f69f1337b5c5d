#include "calibrate_sensor.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <thread>

#include "softfinger/base/error.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/sensing/force_calibration.hpp"
#include "softfinger/sensing/force_sensor.hpp"
#include "softfinger/sensing/force_sensor_emulator.hpp"
#include "stop_signal.hpp"

using namespace softfinger;

namespace {

constexpr double kGravity = 9.80665e-3;  // N a gram
constexpr double kTiny = 1e-12;          // N a unit, so that no reading is refused
constexpr double kMostWeight_g = 5000.0;
constexpr std::chrono::milliseconds kSettling{300};
constexpr std::chrono::milliseconds kListening{1000};

/// Mean of what it says for a second, in its own unit.
double listen(ForceSensor& sensor) {
  std::this_thread::sleep_for(kSettling);
  const ForceSample before = sensor.look();
  std::this_thread::sleep_for(kListening);
  const ForceSample after = sensor.look();
  if (after.count == before.count) {
    throw OperationError(fmt::format(
        "calibrate: the force sensor at {} says nothing; nothing written", sensor.port()));
  }
  return (after.sum - before.sum) / static_cast<double>(after.count - before.count) / kTiny;
}

void load(ForceSensor& sensor, double weight_g, const std::atomic<bool>& stop) {
  if (sensor.emulator() != nullptr) {
    sensor.emulator()->press(kGravity * weight_g);
    return;
  }
  fmt::print(stderr, "Lay {:g} g on the sensor, and press Enter. ", weight_g);
  std::string line;
  const bool answered = static_cast<bool>(std::getline(std::cin, line));
  if (stop.load()) throw OperationError("calibrate: ended before it was done; nothing written");
  if (!answered) throw InputError("calibrate: no answer on the standard input");
}

}  // namespace

void calibrate_sensor(const std::string& device, const std::vector<double>& weights_g,
                      const std::filesystem::path& out) {
  for (const double weight : weights_g) {
    if (weight >= 0.0 && weight <= kMostWeight_g) continue;
    throw InputError(fmt::format("--sensor-g: {:g}: must be 0 to {:g} g", weight, kMostWeight_g));
  }
  const auto settings = load_device(device)->settings().force_sensor;
  if (!settings || settings->kind == ForceSensorKind::kEmulator) {
    ConfigFile(device).root().fail(
        "force_sensor", "nothing to calibrate; give it one of kind \"serial\", \"udp\" or \"osc\"");
  }
  const std::atomic<bool>& stop = stop_on_signals();
  ForceSensorSettings raw = *settings;
  raw.scale = kTiny;
  raw.zero = 0.0;
  ForceSensor sensor(raw);
  std::vector<LoadedReading> readings;
  for (const double weight : weights_g) {
    load(sensor, weight, stop);
    readings.push_back({kGravity * weight, listen(sensor)});
    if (stop.load()) throw OperationError("calibrate: ended before it was done; nothing written");
  }
  const ForceCalibration found = calibrate_force(readings);
  ForceSensorSettings result = *settings;
  result.scale = found.scale;
  result.zero = found.zero;
  std::ofstream file(out);
  file << "# Force sensor as calibrated; take this in place of [force_sensor] in " << device
       << ".\n"
       << fmt::format("# No load was further than {:.4f} N from this.\n", found.deviation)
       << force_sensor_text(result);
  file.close();
  if (!file) {
    std::error_code ignored;
    std::filesystem::remove(out, ignored);
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", out.string()));
  }
  fmt::print(
      "{:g} N a unit, {:g} without load, no load further than {:.4f} N from that\nwrote {}\n",
      found.scale, found.zero, found.deviation, out.string());
}
