#pragma once

#include <string>

#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// `[transport]` as TOML, as a device file with linear joints or not has it: what read_transport()
/// reads, in the units of the file.
[[nodiscard]] std::string transport_text(const TransportSettings& transport, bool linear_joints);

}  // namespace softfinger
