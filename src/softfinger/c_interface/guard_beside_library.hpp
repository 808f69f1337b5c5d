#pragma once

#include <filesystem>

namespace softfinger {

/// softfinger-guard in the folder of the library that this is part of, or in bin beside that, where
/// a package or a prefix has it. Empty where it is in neither: see find_guard_program().
[[nodiscard]] std::filesystem::path guard_beside_library();

}  // namespace softfinger
