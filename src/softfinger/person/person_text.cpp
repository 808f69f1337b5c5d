#include "softfinger/person/person_text.hpp"

#include <fmt/format.h>

#include <optional>
#include <vector>

namespace softfinger {
namespace {

constexpr std::string_view kBlank = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    lines.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return lines;
}

/// "index.size" of " [ index . size ]  # his"; none where the line is no header.
std::optional<std::string> table_of(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with('[') || line.starts_with("[[")) return std::nullopt;
  const std::size_t end = line.find(']');
  if (end == std::string_view::npos) return std::nullopt;
  std::string name;
  for (const char c : line.substr(1, end - 1)) {
    if (kBlank.find(c) == std::string_view::npos) name += c;
  }
  return name;
}

/// How far a value goes, that begins at `from`: past its brackets, before blanks and a comment.
struct ValueEnd {
  std::size_t line, column;
};
ValueEnd end_of_value(const std::vector<std::string>& lines, std::size_t line, std::size_t from) {
  int depth = 0;
  char quote = 0;
  for (std::size_t i = line; i < lines.size(); ++i) {
    std::size_t last = i == line ? from : 0;
    for (std::size_t k = last; k < lines[i].size(); ++k) {
      const char c = lines[i][k];
      if (quote != 0) {
        if (c == '\\' && quote == '"') ++k;
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '#') {
        break;
      } else if (c == '[' || c == '{') {
        ++depth;
      } else if (c == ']' || c == '}') {
        --depth;
      }
      if (kBlank.find(c) == std::string_view::npos) last = k + 1;
    }
    if (depth <= 0) return {i, last};
  }
  return {line, lines[line].size()};
}

/// Column of the value of `key`; none where the line is another key's.
std::optional<std::size_t> value_of(const std::string& line, std::string_view key) {
  const std::size_t equals = line.find('=');
  if (equals == std::string::npos) return std::nullopt;
  if (trimmed(std::string_view(line).substr(0, equals)) != key) return std::nullopt;
  const std::size_t value = line.find_first_not_of(kBlank, equals + 1);
  return value == std::string::npos ? line.size() : value;
}

bool says_something(const std::string& line) {
  const std::string_view text = trimmed(line);
  return !text.empty() && !text.starts_with('#');
}

}  // namespace

std::string with_key(std::string_view text, std::string_view finger, std::string_view table,
                     std::string_view key, std::string_view value) {
  std::vector<std::string> lines = lines_of(text);
  const std::string wanted = fmt::format("{}.{}", finger, table);
  const std::string prefix = fmt::format("{}.", finger);
  bool within = false;
  std::optional<std::size_t> after;         // the last key of the table
  std::optional<std::size_t> after_finger;  // the last line of the finger's tables
  bool of_finger = false;
  bool changed = false;
  for (std::size_t i = 0; i < lines.size() && !changed; ++i) {
    if (const auto name = table_of(lines[i])) {
      within = *name == wanted;
      of_finger = *name == finger || name->starts_with(prefix);
    } else if (within) {
      if (const auto at = value_of(lines[i], key)) {
        const ValueEnd end = end_of_value(lines, i, *at);
        lines[i] =
            lines[i].substr(0, *at) + std::string(value) + lines[end.line].substr(end.column);
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                    lines.begin() + static_cast<std::ptrdiff_t>(end.line) + 1);
        changed = true;
      }
    }
    if (within && says_something(lines[i])) after = i;
    if (of_finger && says_something(lines[i])) after_finger = i;
  }
  if (!changed) {
    const std::string line = fmt::format("{} = {}", key, value);
    std::vector<std::string> added{line};
    if (!after) added = {"", fmt::format("[{}]", wanted), line};
    std::size_t place = lines.size();
    if (after_finger) place = *after_finger + 1;
    if (after) place = *after + 1;
    // What is said below the last line of what it is about stays with it.
    while (place < lines.size() && trimmed(lines[place]).starts_with('#')) ++place;
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(place), added.begin(), added.end());
  }
  std::string result;
  for (const std::string& line : lines) result += line + '\n';
  return result;
}

}  // namespace softfinger
