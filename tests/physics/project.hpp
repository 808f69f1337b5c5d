#pragma once

#include <filesystem>

namespace softfinger {

inline const std::filesystem::path kProject = SOFTFINGER_SOURCE_DIR;

}  // namespace softfinger
