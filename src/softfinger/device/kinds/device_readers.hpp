#pragma once

#include <memory>

#include "softfinger/device/device.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {

// One reader a kind: asks the file for the kind's keys, builds the device and checks it. The
// settings come with their kind. device_kinds.cpp has the table of them.

[[nodiscard]] std::shared_ptr<const Device> read_platform_3rrs(const ConfigFile& file,
                                                               DeviceSettings settings);
[[nodiscard]] std::shared_ptr<const Device> read_plate_2dof(const ConfigFile& file,
                                                            DeviceSettings settings);
[[nodiscard]] std::shared_ptr<const Device> read_cable_platform(const ConfigFile& file,
                                                                DeviceSettings settings);
[[nodiscard]] std::shared_ptr<const Device> read_pin_array(const ConfigFile& file,
                                                           DeviceSettings settings);
[[nodiscard]] std::shared_ptr<const Device> read_delta_tactor(const ConfigFile& file,
                                                              DeviceSettings settings);
[[nodiscard]] std::shared_ptr<const Device> read_membrane(const ConfigFile& file,
                                                          DeviceSettings settings);
[[nodiscard]] std::shared_ptr<const Device> read_roller(const ConfigFile& file,
                                                        DeviceSettings settings);

/// A surface of the file's own choice on up to three linear drives.
[[nodiscard]] std::shared_ptr<const Device> read_linear_drives(const ConfigFile& file,
                                                               DeviceSettings settings);
/// Asks for all keys of linear drives; meshes are not opened.
[[nodiscard]] DeviceSettings read_linear_drives_keys(const ConfigFile& file,
                                                     DeviceSettings settings);

[[nodiscard]] std::shared_ptr<const Device> read_mechanism(const ConfigFile& file,
                                                           DeviceSettings settings);
/// Asks for all keys of a mechanism and leaves open whether its loops close; meshes are not opened.
[[nodiscard]] DeviceSettings read_mechanism_keys(const ConfigFile& file, DeviceSettings settings);

}  // namespace softfinger
