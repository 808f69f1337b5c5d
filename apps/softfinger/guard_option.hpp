#pragma once

#include <filesystem>

/// softfinger-guard, beside this program. Throws OperationError where it is not there.
[[nodiscard]] std::filesystem::path guard_program();
