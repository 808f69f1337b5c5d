#include "softfinger/sensing/force_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kMostDeviation = 0.05;  // of the largest load

}  // namespace

ForceCalibration calibrate_force(std::span<const LoadedReading> readings) {
  const auto count = static_cast<double>(readings.size());
  double force = 0.0;
  double reading = 0.0;
  double largest = 0.0;
  for (const LoadedReading& each : readings) {
    force += each.force / count;
    reading += each.reading / count;
    largest = std::max(largest, std::abs(each.force));
  }
  double ff = 0.0;
  double fr = 0.0;
  double rr = 0.0;
  for (const LoadedReading& each : readings) {
    ff += (each.force - force) * (each.force - force);
    fr += (each.force - force) * (each.reading - reading);
    rr += (each.reading - reading) * (each.reading - reading);
  }
  if (readings.size() < 2 || !(ff > 0.0)) {
    throw InputError("a calibration needs two different loads, such as nothing and 100 g");
  }
  if (!(rr > 0.0) || fr == 0.0) {
    throw InputError(
        fmt::format("the sensor says {:g} under every load: it is dead or stuck, or the "
                    "weights do not lie on it",
                    reading));
  }
  ForceCalibration found;
  found.scale = ff / fr;
  found.zero = reading - force / found.scale;
  for (const LoadedReading& each : readings) {
    found.deviation =
        std::max(found.deviation, std::abs(found.scale * (each.reading - found.zero) - each.force));
  }
  if (found.deviation > kMostDeviation * largest) {
    throw InputError(
        fmt::format("the readings are no line: a load is {:.3f} N off, of {:.3f} N; look "
                    "how the weights lie on the sensor",
                    found.deviation, largest));
  }
  return found;
}

std::string force_sensor_text(const ForceSensorSettings& settings) {
  const bool number = !settings.port.empty() && std::ranges::all_of(settings.port, [](char c) {
    return c >= '0' && c <= '9';
  });
  std::string text = fmt::format("[force_sensor]\nkind = \"{}\"\nport = {}\n",
                                 row_of(kForceSensorKinds, settings.kind).name,
                                 number ? settings.port : fmt::format("\"{}\"", settings.port));
  if (settings.kind == ForceSensorKind::kSerial) text += fmt::format("baud = {}\n", settings.baud);
  text += fmt::format("rate_Hz = {:#.6g}\nscale_N = {:#.8g}\nzero = {:#.10g}\nstale_ms = {:#.6g}\n",
                      settings.rate, settings.scale, settings.zero, settings.stale / ms);
  if (settings.refine) text += "refine = true\n";
  return text;
}

}  // namespace softfinger
