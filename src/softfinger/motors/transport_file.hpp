#pragma once

#include <string>
#include <string_view>

#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/joint_limits.hpp"
#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// Reads `[transport]` of a device whose joints have these limits.
[[nodiscard]] TransportSettings read_transport(const ConfigTable& table, const JointLimits& limits);

/// A `[transport]` of a kind with what it must say, with a servo for each of these joints; TOML.
[[nodiscard]] std::string transport_example(std::string_view kind, const JointLimits& limits);

/// What a key of `[transport]` or `[[transport.servo]]` means, in one line; empty for others.
[[nodiscard]] std::string_view transport_key_meaning(std::string_view kind, std::string_view key);

}  // namespace softfinger
