#pragma once

#include <filesystem>

namespace softfinger {

/// The user's folder for what can be made again: `softfinger` in $XDG_CACHE_HOME or ~/.cache.
/// Empty: there is none.
[[nodiscard]] std::filesystem::path user_cache_folder();

}  // namespace softfinger
