#pragma once

#include <string>

namespace softfinger {

/// The checkout and the build under test, absolute, without a slash at the end. One source knows
/// them (folders.cpp), so that every other one is compiled alike in each checkout.
[[nodiscard]] const std::string& source_folder();
[[nodiscard]] const std::string& build_folder();
/// The guard of that build.
[[nodiscard]] const std::string& guard_program();

}  // namespace softfinger
