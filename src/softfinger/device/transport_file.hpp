#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "softfinger/base/config_file.hpp"
#include "softfinger/device/device.hpp"

namespace softfinger {

/// Reads `[transport]` of a device whose joints have these limits.
[[nodiscard]] TransportSettings read_transport(const ConfigTable& table, const JointLimits& limits);

/// Names of all kinds of transport.
[[nodiscard]] const std::vector<std::string>& transport_kinds();

/// A `[transport]` of a kind with all its keys, with a servo for each joint; TOML.
[[nodiscard]] std::string transport_example(std::string_view kind, const Device& device);

/// What a key of `[transport]` or `[[transport.servo]]` means, in one line; empty for others.
[[nodiscard]] std::string_view transport_key_meaning(std::string_view kind, std::string_view key);

}  // namespace softfinger
