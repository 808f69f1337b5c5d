#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "softfinger/files/config_file.hpp"

namespace softfinger {

// What a key may hold, in the words of JSON Schema.

[[nodiscard]] nlohmann::ordered_json number_schema(std::string_view key, const Range& range);
[[nodiscard]] nlohmann::ordered_json integer_schema(int min, int max);
[[nodiscard]] nlohmann::ordered_json numbers_schema(std::string_view key, int size,
                                                    const Range& range);

}  // namespace softfinger
