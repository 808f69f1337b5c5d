#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// Reads a device file (TOML, keys in docs/files.md) and builds the device. Throws InputError with
/// file, line and key: besides wrong keys and values for a home that is out of the limits, has no
/// inverse kinematics or is singular, a retracted pose out of the workspace, and servos whose
/// pulses do not cover the joint limits. `mount_shift`: see DeviceSettings, m.
[[nodiscard]] std::shared_ptr<const Device> load_device(const std::filesystem::path& file,
                                                        double mount_shift = 0.0);
/// The same of a file's text at hand (DeviceSettings::text), which may have changed since.
[[nodiscard]] std::shared_ptr<const Device> load_device(const std::filesystem::path& file,
                                                        const std::string& text,
                                                        double mount_shift);

/// A JSON Schema of the device files of one kind, by what their reader asks for. Throws InputError
/// for an unknown kind.
[[nodiscard]] std::string device_schema(const std::string& kind);
/// Of all kinds.
[[nodiscard]] std::string device_schema();

}  // namespace softfinger
