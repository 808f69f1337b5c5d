#pragma once

#include <filesystem>
#include <string_view>

namespace softfinger {

/// A part of this program that is a file of its own, loaded where it is needed: what it links costs
/// all others neither time to start nor a package. Beside the program or the library where they are
/// built, else where they are installed; empty: not there.
[[nodiscard]] std::filesystem::path module_file(std::string_view name);

/// The function of that name in the module, which stays loaded; nullptr where it cannot be.
[[nodiscard]] void* module_function(const std::filesystem::path& file, const char* name);

}  // namespace softfinger
