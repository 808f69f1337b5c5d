#include "softfinger/files/toml_text.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>

#include "softfinger/base/error.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {
namespace {

/// Places in a text by lines and columns, of code points, from 1.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {
    begins_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') begins_.push_back(i + 1);
    }
  }
  [[nodiscard]] std::size_t offset(const toml::source_position& at) const {
    std::size_t offset = begins_[std::min<std::size_t>(at.line, begins_.size()) - 1];
    for (std::size_t column = 1; column < at.column && offset < text_.size(); ++column) {
      do {
        ++offset;
      } while (offset < text_.size() && (static_cast<unsigned char>(text_[offset]) & 0xc0) == 0x80);
    }
    return offset;
  }
  /// After the line's last character, before what ends it.
  [[nodiscard]] std::size_t line_end(std::size_t offset) const {
    return std::min(text_.find('\n', offset), text_.size());
  }

 private:
  std::string_view text_;
  std::vector<std::size_t> begins_;
};

std::string joined(const std::string& way, std::string_view key) {
  return way.empty() ? std::string(key) : fmt::format("{}.{}", way, key);
}

std::string_view parent_of(std::string_view way) {
  const std::size_t dot = way.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : way.substr(0, dot);
}

/// Calls visit(way, heading, node) for every value, tables and arrays first; `heading` is what a
/// table of its own is called between its brackets, the way without elements of arrays.
template <typename Visit>
void walk(const std::string& way, const std::string& heading, const toml::node& node,
          const Visit& visit) {
  visit(way, heading, node);
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table) {
      walk(joined(way, key.str()), joined(heading, key.str()), value, visit);
    }
  } else if (const toml::array* array = node.as_array()) {
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& element = (*array)[i];
      walk(joined(way, std::to_string(i)), heading, element, visit);
      const toml::table* fields = element.as_table();
      const auto name = fields != nullptr ? (*fields)["name"].value<std::string>() : std::nullopt;
      if (name && !name->empty()) walk(joined(way, *name), heading, element, visit);
    }
  }
}

/// Whether a table of this name is opened here, and not one below it or in a line with others.
bool opens(std::string_view text, std::string_view heading) {
  const std::size_t brackets = text.starts_with("[[") ? 2 : 1;
  if (!text.starts_with('[')) return false;
  text = text.substr(brackets, text.find(']') - brackets);
  const std::size_t begin = text.find_first_not_of(" \t");
  const std::size_t end = text.find_last_not_of(" \t");
  return begin != std::string_view::npos && text.substr(begin, end + 1 - begin) == heading;
}

}  // namespace

TomlText::TomlText(const std::filesystem::path& file, std::string text) : text_(std::move(text)) {
  static_cast<void>(ConfigFile(file, text_));  // says what is wrong with it
  const toml::table root = toml::parse(text_);
  const Lines lines(text_);
  walk("", "", root, [&](const std::string& way, const std::string& heading, const auto& node) {
    const std::size_t begin = lines.offset(node.source().begin);
    if (node.is_number()) {
      const std::size_t end = std::min(text_.find_first_of(", \t\r\n]}#", begin), text_.size());
      places_.push_back({way, begin, end, {}, {}, node.template value<double>().value_or(0.0)});
    } else if (node.is_table() && !way.empty() &&
               opens(std::string_view(text_).substr(begin), heading)) {
      tables_.push_back({way, lines.line_end(begin)});
    } else if (!way.empty()) {
      if (const auto word = node.template value<std::string>()) words_.push_back(*word);
      others_.push_back(way);
    }
  });
}

const TomlText::Place* TomlText::find(std::string_view way) const {
  const auto found = std::ranges::find(places_, way, &Place::way);
  return found == places_.end() ? nullptr : &*found;
}

std::optional<double> TomlText::number(std::string_view way) const {
  const Place* place = find(way);
  return place == nullptr ? std::nullopt : std::optional(place->value);
}

bool TomlText::is_same(std::string_view way, std::string_view other) const {
  const Place* a = find(way);
  const Place* b = find(other);
  if (a == nullptr || b == nullptr) return false;
  // Several may be put in at one place.
  return a == b || (a->begin == b->begin && a->end == b->end && a->begin < a->end);
}

std::vector<std::string> TomlText::ways() const {
  std::vector<std::string> ways;
  for (const Place& place : places_) ways.push_back(place.way);
  return ways;
}

bool TomlText::add(std::string_view way, double value) {
  if (find(way) != nullptr) return true;
  const std::string table(parent_of(way));
  const std::string_view key = way.substr(table.empty() ? 0 : table.size() + 1);
  const auto heading = std::ranges::find(tables_, table, &Table::way);
  Place place{std::string(way), 0, 0, {}, {}, value};
  if (heading != tables_.end()) {
    place.begin = place.end = heading->line_end;
    place.before = fmt::format("\n{} = ", key);
  } else if (table.empty()) {
    place.before = fmt::format("{} = ", key);
    place.after = "\n";
  } else {
    // Nothing of that name may be there, and nothing above it that is no table of its own.
    for (std::string_view above = table; !above.empty(); above = parent_of(above)) {
      if (std::ranges::find(others_, above) != others_.end() || find(above) != nullptr)
        return false;
    }
    place.begin = place.end = text_.size();
    place.before = fmt::format("\n[{}]\n{} = ", table, key);
    place.after = "\n";
  }
  places_.push_back(std::move(place));
  return true;
}

std::string TomlText::with(const std::vector<std::pair<std::string, double>>& numbers) const {
  std::vector<std::pair<const Place*, double>> changes;
  for (const auto& [way, value] : numbers) {
    const Place* place = find(way);
    if (place == nullptr) throw std::logic_error(fmt::format("{}: was not added", way));
    changes.emplace_back(place, value);
  }
  std::ranges::stable_sort(changes, {}, [](const auto& change) {
    return std::pair(change.first->begin, parent_of(change.first->way));
  });
  std::string result;
  std::size_t done = 0;
  std::string_view opened;
  for (const auto& [place, value] : changes) {
    result.append(text_, done, place->begin - done);
    // Two keys put into one table that was not there share its heading.
    const bool again = place->begin == text_.size() && opened == parent_of(place->way) &&
                       place->before.starts_with("\n[");
    const std::size_t skip = again ? place->before.find('\n', 1) + 1 : 0;
    result +=
        fmt::format("{}{}{}", std::string_view(place->before).substr(skip), value, place->after);
    if (place->before.starts_with("\n[")) opened = parent_of(place->way);
    done = place->end;
  }
  return result.append(text_, done);
}

}  // namespace softfinger
