#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger {

/// A row of a table of names. One table has all there is of its subject: files, flags, output, the
/// wire, the page and the docs have names and words from it. A table that tells more has rows of
/// its own, with a `value` and a `name`.
template <typename T>
struct NameRow {
  T value;
  std::string_view name;        ///< in files, flags, output and on the wire
  std::string_view words = {};  ///< that people read; empty: the name
};

/// The row of a value; the first row where none is its own.
template <typename Table, typename T>
[[nodiscard]] constexpr const auto& row_of(const Table& table, const T& value) {
  const auto row = std::ranges::find(table, value, [](const auto& each) { return each.value; });
  return row == table.end() ? *table.begin() : *row;
}

/// The row of that name; null where there is none.
template <typename Table>
[[nodiscard]] constexpr auto row_named(const Table& table, std::string_view name)
    -> decltype(&*table.begin()) {
  const auto row = std::ranges::find(table, name, [](const auto& each) { return each.name; });
  return row == table.end() ? nullptr : &*row;
}

/// All names, in the order of the table.
template <typename Table>
[[nodiscard]] std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  names.reserve(std::ranges::size(table));
  for (const auto& row : table) names.emplace_back(row.name);
  return names;
}

/// "a, b or c", where `last` is "or".
[[nodiscard]] std::string listed(const std::vector<std::string>& names, std::string_view last);

}  // namespace softfinger
