#include "softfinger/sensing/force_sensor_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/sensing/force_port.hpp"

namespace softfinger {
namespace {

constexpr double kStaleReadings = 3.0;  ///< that are missing, where the file says nothing
constexpr double kLeastStale = 0.1;     ///< s, where the file says nothing
constexpr Range kRate_Hz{.min = 1.0, .max = 10000.0};
constexpr Range kStale_ms{.min = 1.0, .max = 2000.0};
constexpr Range kScale{.min = -1e6, .max = 1e6};
constexpr Range kHysteresis{.min = 0.0, .max = 0.5};
constexpr Range kZero{.min = -1e12, .max = 1e12};

}  // namespace

ForceSensorSettings read_force_sensor(const ConfigTable& table) {
  ForceSensorSettings sensor;
  sensor.kind =
      row_named(kForceSensorKinds, table.choice("kind", names_of(kForceSensorKinds)))->value;
  sensor.port = table.text_or_integer("port", 1, 65535, ForceSensorSettings::kEmulated);
  sensor.baud = static_cast<unsigned>(table.integer("baud", 300, 4000000, 115200));
  sensor.rate = table.number("rate_Hz", kRate_Hz, sensor.rate);
  sensor.scale = table.number("scale_N", kScale, sensor.scale);
  sensor.zero = table.number("zero", kZero, sensor.zero);
  const double period = 1.0 / sensor.rate;
  sensor.stale =
      table.number("stale_ms", kStale_ms, std::max(kLeastStale, kStaleReadings * period));
  sensor.noise = table.number("noise_N", Range::at_least(0.0), 0.0);
  sensor.hysteresis = table.number("hysteresis", kHysteresis, 0.0);
  sensor.refine = table.boolean("refine", false);
  if (sensor.stale < period) {
    table.fail("stale_ms", fmt::format("{:g} is shorter than the {:g} ms from one reading to the "
                                       "next (rate_Hz); at least that",
                                       sensor.stale / ms, period / ms));
  }
  const std::string why = why_no_force_port(sensor);
  if (!why.empty()) table.fail("port", why);
  return sensor;
}

}  // namespace softfinger
