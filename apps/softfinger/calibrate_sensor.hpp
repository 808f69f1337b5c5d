#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// `device calibrate DEVICE --sensor-g ...`: reads the device's force sensor under known weights
/// (g), one after the other, and writes a `[force_sensor]` with the scale and zero found to `out`,
/// a new file. An emulated sensor is loaded by itself, else a person is asked to. Throws
/// InputError, OperationError.
void calibrate_sensor(const std::string& device, const std::vector<double>& weights_g,
                      const std::filesystem::path& out);
