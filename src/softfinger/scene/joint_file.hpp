#pragma once

#include "softfinger/contact/object_dynamics.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {

/// `[object.joint]`, but for its parent, whose number others tell. Throws InputError with file,
/// line and key.
[[nodiscard]] Joint read_joint(const ConfigTable& table);

}  // namespace softfinger
