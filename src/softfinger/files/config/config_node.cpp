#include "softfinger/files/config/config_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kMaxListedKeys = 16;  // named when none is near

std::string describe(const toml::node& value) {
  switch (value.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return fmt::format("an array of {}", value.as_array()->size());
    case toml::node_type::string:
      return fmt::format("the text \"{}\"", shown(value.as_string()->get()));
    case toml::node_type::integer:
      return fmt::format("the number {}", value.as_integer()->get());
    case toml::node_type::floating_point:
      return fmt::format("the number {}", value.as_floating_point()->get());
    case toml::node_type::boolean:
      return value.as_boolean()->get() ? "true" : "false";
    default:
      return "a date or time";
  }
}

std::string describe(const Range& range) {
  const bool below = std::isfinite(range.min);
  const bool above = std::isfinite(range.max);
  const std::string low =
      fmt::format("{} {}", range.open_min ? "greater than" : "at least", range.min);
  const std::string high =
      fmt::format("{} {}", range.open_max ? "less than" : "at most", range.max);
  if (below && above) return fmt::format("{} and {}", low, high);
  return below ? low : high;
}

bool contains(const Range& range, double value) {
  return (range.open_min ? value > range.min : value >= range.min) &&
         (range.open_max ? value < range.max : value <= range.max);
}

/// The part of a key before its unit, roughly: up to the last underscore.
std::string_view stem(std::string_view key) { return key.substr(0, key.rfind('_')); }

}  // namespace

std::string shown(std::string_view text) {
  constexpr std::size_t kMaxLength = 60;
  std::string result(text.substr(0, kMaxLength));
  std::replace_if(
      result.begin(), result.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  if (text.size() > kMaxLength) result += "...";
  return result;
}

ConfigTable::Node::Rule& ConfigTable::Node::rule_of(std::string_view key) {
  const auto known =
      std::find_if(rules.begin(), rules.end(), [&](const Rule& rule) { return rule.key == key; });
  if (known == rules.end()) {
    throw std::logic_error(fmt::format("{}: was not asked for", path_of(key)));
  }
  return *known;
}

void ConfigTable::Node::rule(std::string_view key, bool required, Json schema) {
  const auto known =
      std::find_if(rules.begin(), rules.end(), [&](const Rule& rule) { return rule.key == key; });
  if (known == rules.end()) rules.push_back({std::string(key), required, std::move(schema)});
}

ConfigTable::Node::Answer& ConfigTable::Node::answer(std::string_view key) {
  for (auto& [name, value] : asked) {
    if (name == key) return value;
  }
  return asked.emplace_back(std::string(key), std::monostate{}).second;
}

bool ConfigTable::Node::is_asked(std::string_view key) const {
  return std::any_of(asked.begin(), asked.end(), [&](const auto& a) { return a.first == key; });
}

std::string ConfigTable::Node::path_of(std::string_view key) const {
  const std::string name = shown(key);
  if (key.empty()) return path;
  return path.empty() ? name : path + "." + name;
}

std::size_t ConfigTable::Node::line_of(std::string_view key) const {
  if (table != nullptr) {
    const auto found = table->find(key);
    if (found != table->end()) return found->first.source().begin.line;
  }
  return line;
}

const toml::node* ConfigTable::Node::find(std::string_view key) {
  answer(key);
  return table == nullptr ? nullptr : table->get(key);
}

void ConfigTable::Node::fail(std::size_t at_line, std::string_view at_path,
                             std::string_view message) const {
  std::string text = document->file;
  if (at_line > 0) text += fmt::format(":{}", at_line);
  if (!at_path.empty()) text += fmt::format(": {}", at_path);
  throw InputError(fmt::format("{}: {}", text, message));
}

void ConfigTable::Node::fail(std::string_view key, std::string_view message) const {
  fail(line_of(key), path_of(key), message);
}

void ConfigTable::Node::fail_type(std::string_view key, std::string_view expected,
                                  const toml::node& found) const {
  fail(key, fmt::format("expected {}, found {}", expected, describe(found)));
}

double ConfigTable::Node::checked_number(std::string_view key, std::string_view name,
                                         const toml::node& value, const Range& range) const {
  const auto number = value.is_number() ? value.value<double>() : std::nullopt;
  if (!number) {
    fail(line_of(key), path_of(name), fmt::format("expected a number, found {}", describe(value)));
  }
  if (!std::isfinite(*number)) {
    fail(line_of(key), path_of(name),
         fmt::format("expected a finite number, found {}", describe(value)));
  }
  if (!contains(range, *number)) {
    fail(line_of(key), path_of(name),
         fmt::format("must be {}, found {}", describe(range), *number));
  }
  return *number;
}

double ConfigTable::Node::take_number(std::string_view key, const toml::node& value,
                                      const Range& range) {
  const double number = checked_number(key, key, value, range);
  answer(key) = value.is_integer() ? Json(value.as_integer()->get()) : Json(number);
  return number * unit_scale(key);
}

int ConfigTable::Node::take_integer(std::string_view key, const toml::node& value, int min,
                                    int max) {
  if (!value.is_integer()) fail_type(key, "a whole number", value);
  const std::int64_t number = value.as_integer()->get();
  if (number < min || number > max) {
    fail(key, fmt::format("must be between {} and {}, found {}", min, max, number));
  }
  answer(key) = Json(number);
  return static_cast<int>(number);
}

std::string ConfigTable::Node::take_text(std::string_view key, const toml::node& value) {
  if (!value.is_string()) fail_type(key, "a text in quotes", value);
  answer(key) = Json(value.as_string()->get());
  return value.as_string()->get();
}

std::filesystem::path ConfigTable::Node::take_path(std::string_view key, const toml::node& value) {
  const std::string text = take_text(key, value);
  if (text.empty()) fail(key, "expected a path, found an empty text");
  if (text.find('\0') != std::string::npos) fail(key, "a path cannot contain a zero character");
  return document->directory / text;
}

Eigen::VectorXd ConfigTable::Node::take_numbers(std::string_view key, const toml::node& value,
                                                int size, const Range& range) {
  const toml::array* array = value.as_array();
  if (array == nullptr || array->size() != static_cast<std::size_t>(size)) {
    fail_type(key, fmt::format("an array of {} number{}", size, size == 1 ? "" : "s"), value);
  }
  Eigen::VectorXd result(size);
  Json json = Json::array();
  for (int i = 0; i < size; ++i) {
    const toml::node& element = (*array)[static_cast<std::size_t>(i)];
    const double number = checked_number(key, fmt::format("{}[{}]", key, i), element, range);
    json.push_back(element.is_integer() ? Json(element.as_integer()->get()) : Json(number));
    result[i] = number * unit_scale(key);
  }
  answer(key) = std::move(json);
  return result;
}

ConfigTable::Node::Child ConfigTable::Node::child(std::string_view key, const toml::node* value) {
  Answer& slot = answer(key);
  if (const Child* known = std::get_if<Child>(&slot)) return *known;
  if (value != nullptr && !value->is_table()) {
    fail_type(key, fmt::format("a table, [{}]", path_of(key)), *value);
  }
  slot = std::make_shared<Node>(Node{.document = document,
                                     .table = value == nullptr ? nullptr : value->as_table(),
                                     .path = path_of(key),
                                     .line = line_of(key),
                                     .asked = {},
                                     .rules = {}});
  return std::get<Child>(slot);
}

std::vector<ConfigTable::Node::Child> ConfigTable::Node::children(std::string_view key,
                                                                  const toml::node* value) {
  if (const auto* known = std::get_if<std::vector<Child>>(&answer(key))) return *known;
  std::vector<Child> result;
  if (value != nullptr) {
    const std::string expected = fmt::format("an array of tables, [[{}]]", path_of(key));
    const toml::array* array = value->as_array();
    if (array == nullptr) fail_type(key, expected, *value);
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& element = (*array)[i];
      if (!element.is_table()) fail_type(key, expected, element);
      result.push_back(std::make_shared<Node>(Node{.document = document,
                                                   .table = element.as_table(),
                                                   .path = fmt::format("{}[{}]", path_of(key), i),
                                                   .line = element.source().begin.line,
                                                   .asked = {},
                                                   .rules = {}}));
    }
    answer(key) = result;
  }
  return result;
}

Json ConfigTable::Node::as_read() const {
  Json object = Json::object();
  for (const auto& [key, value] : asked) {
    if (const Json* scalar = std::get_if<Json>(&value)) {
      object[key] = *scalar;
    } else if (const Child* table_node = std::get_if<Child>(&value)) {
      object[key] = (*table_node)->as_read();
    } else if (const auto* list = std::get_if<std::vector<Child>>(&value)) {
      Json array = Json::array();
      for (const Child& element : *list) array.push_back(element->as_read());
      object[key] = std::move(array);
    }
  }
  return object;
}

std::vector<std::string> ConfigTable::Node::keys_in_file_order() const {
  std::vector<std::pair<toml::source_position, std::string>> found;
  if (table != nullptr) {
    for (auto&& [key, value] : *table) {
      found.emplace_back(key.source().begin, std::string(key.str()));
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  names.reserve(found.size());
  for (auto& [position, name] : found) names.push_back(std::move(name));
  return names;
}

std::vector<std::string> ConfigTable::Node::unasked_keys() const {
  std::vector<std::string> names = keys_in_file_order();
  std::erase_if(names, [&](const std::string& name) { return is_asked(name); });
  return names;
}

void ConfigTable::Node::finish() const {
  const std::vector<std::string> unknown = unasked_keys();
  if (!unknown.empty()) fail_unknown(unknown.front());
  for (const auto& [key, value] : asked) {
    if (const Child* table_node = std::get_if<Child>(&value)) (*table_node)->finish();
    if (const auto* list = std::get_if<std::vector<Child>>(&value)) {
      for (const Child& element : *list) element->finish();
    }
  }
}

void ConfigTable::Node::fail_unknown(std::string_view key) const {
  std::vector<std::string> known;
  for (const auto& [name, value] : asked) known.push_back(name);
  const std::string nearest = nearest_word(key, known);
  std::string hint;
  if (!nearest.empty()) {
    hint = fmt::format("; did you mean '{}'?", nearest);
  } else if (known.empty()) {
    hint = "; no keys are known here";
  } else if (known.size() <= kMaxListedKeys) {
    hint = fmt::format("; known keys: {}", fmt::join(known, ", "));
  }
  fail(key, fmt::format("unknown key '{}'{}", shown(key), hint));
}

const toml::node& ConfigTable::Node::require(std::string_view key, std::string_view expected) {
  if (const toml::node* value = find(key)) return *value;
  // A misspelt key shows up here first, as the absence of the right one.
  const std::vector<std::string> candidates = unasked_keys();
  for (const std::string& candidate : candidates) {
    if (stem(candidate) == stem(key) || candidate == stem(key)) {
      fail(candidate, fmt::format("unknown key '{}'; did you mean '{}'?", shown(candidate), key));
    }
  }
  const std::string nearest = nearest_word(key, candidates);
  if (!nearest.empty()) {
    fail(nearest, fmt::format("unknown key '{}'; did you mean '{}'?", shown(nearest), key));
  }
  fail(key, fmt::format("missing; expected {}", expected));
}

}  // namespace softfinger
