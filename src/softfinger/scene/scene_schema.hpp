#pragma once

#include <string>

namespace softfinger {

/// is_finger_name() as a regular expression.
inline constexpr const char* kFingerNamePattern = "^[A-Za-z0-9_-]{1,64}$";

/// A JSON Schema of scene files, by what their reader asks for.
[[nodiscard]] std::string scene_schema();

}  // namespace softfinger
