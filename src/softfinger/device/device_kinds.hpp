#pragma once

#include <memory>

#include "softfinger/base/config_file.hpp"
#include "softfinger/device/device.hpp"

namespace softfinger {

// One reader a kind: asks the file for the kind's keys, builds the device and checks it. The
// settings come with their kind. device_file.cpp has the table of names.

[[nodiscard]] std::shared_ptr<const Device> read_platform_3rrs(const ConfigFile& file,
                                                               DeviceSettings settings);

}  // namespace softfinger
