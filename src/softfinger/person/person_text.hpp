#pragma once

#include <string>
#include <string_view>

namespace softfinger {

/// The text of a TOML file with `key` of the table [finger.table] set to `value` (as TOML). All
/// else stays as it is written, comments too: a value that is there gives way to the new one, a key
/// that is not goes behind the table's last, a table that is not behind the finger's last, or to
/// the end. Knows tables by headers of bare keys alone: whoever wants to be sure reads the result.
[[nodiscard]] std::string with_key(std::string_view text, std::string_view finger,
                                   std::string_view table, std::string_view key,
                                   std::string_view value);

}  // namespace softfinger
