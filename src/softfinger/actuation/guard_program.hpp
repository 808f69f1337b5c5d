#pragma once

#include <filesystem>

namespace softfinger {

/// Where softfinger-guard is: beside the program that runs, or where softfinger was installed.
/// Empty where it is not there.
[[nodiscard]] std::filesystem::path find_guard_program();

}  // namespace softfinger
