#pragma once

#include <cstdint>

namespace softfinger {

/// Hash of the program or library that this function is part of, as it lies in memory: its code and
/// constants, and nothing that is written to. What another build computes may differ, and has
/// another hash.
[[nodiscard]] std::uint64_t code_hash();

}  // namespace softfinger
