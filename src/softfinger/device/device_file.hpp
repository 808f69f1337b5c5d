#pragma once

#include <filesystem>
#include <memory>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// Reads a device file (TOML, keys in docs/files.md) and builds the device. Throws InputError with
/// file, line and key: besides wrong keys and values for a home that is out of the limits, has no
/// inverse kinematics or is singular, a retracted pose out of the workspace, and servos whose
/// pulses do not cover the joint limits.
[[nodiscard]] std::shared_ptr<const Device> load_device(const std::filesystem::path& file);

}  // namespace softfinger
