#pragma once

#include <filesystem>

#include "../support/folders.hpp"

namespace softfinger {

inline const std::filesystem::path kProject = source_folder();

}  // namespace softfinger
