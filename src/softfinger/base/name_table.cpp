#include "softfinger/base/name_table.hpp"

#include <fmt/format.h>

namespace softfinger {

std::string listed(const std::vector<std::string>& names, std::string_view last) {
  if (names.size() < 2) return names.empty() ? std::string() : names.front();
  return fmt::format("{} {} {}", fmt::join(names.begin(), names.end() - 1, ", "), last,
                     names.back());
}

}  // namespace softfinger
