#pragma once

#include <string_view>

namespace softfinger {

/// The unit named by the suffix of a key in words, "degrees per second"; empty for a key without a
/// unit. The suffixes are those of unit_scale().
[[nodiscard]] std::string_view unit_words(std::string_view key);

/// The same as a symbol, "deg/s", "mm2", "N mm"; empty for a key without a unit.
[[nodiscard]] std::string_view unit_symbol(std::string_view key);

}  // namespace softfinger
