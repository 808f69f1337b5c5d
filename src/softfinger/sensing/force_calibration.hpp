#pragma once

#include <span>
#include <string>

#include "softfinger/sensing/force_sensor_settings.hpp"

namespace softfinger {

/// What a sensor said, on average, under a known load.
struct LoadedReading {
  double force = 0.0;    ///< N
  double reading = 0.0;  ///< in its own unit
};

/// force = scale * (reading - zero).
struct ForceCalibration {
  double scale = 1.0;      ///< N a unit
  double zero = 0.0;       ///< in the sensor's unit
  double deviation = 0.0;  ///< largest difference of a load from that line, N
};

/// The line through readings under known loads, by least squares. Throws InputError for fewer than
/// two different loads, for a sensor that says the same under all of them, and for one whose
/// readings are no line, to a twentieth of the largest load.
[[nodiscard]] ForceCalibration calibrate_force(std::span<const LoadedReading> readings);

/// `[force_sensor]` of a device file.
[[nodiscard]] std::string force_sensor_text(const ForceSensorSettings& settings);

}  // namespace softfinger
