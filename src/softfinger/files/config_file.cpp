#include "softfinger/files/config_file.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>
#include <variant>

#include "softfinger/base/error.hpp"
#include "softfinger/base/unit_words.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/text_file.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFileSize = 4u << 20;  // bytes
constexpr std::size_t kMaxListedKeys = 16;      // named when none is near

/// Text as part of a one-line message: no control characters, not endless.
std::string shown(std::string_view text) {
  constexpr std::size_t kMaxLength = 60;
  std::string result(text.substr(0, kMaxLength));
  std::replace_if(
      result.begin(), result.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  if (text.size() > kMaxLength) result += "...";
  return result;
}

std::string_view line_of(std::string_view text, std::size_t number) {
  for (std::size_t line = 1; line < number; ++line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find_first_of("\r\n"));
}

/// Our own words for what the parser met.
std::string parse_message(const toml::parse_error& error, std::string_view text) {
  const std::string_view description = error.description();
  const std::string line = shown(line_of(text, error.source().begin.line));
  if (description.find("redefine") != std::string_view::npos) {
    return fmt::format("a key or table is given twice: {}", line);
  }
  if (description.find("utf-8") != std::string_view::npos ||
      description.find("UTF-8") != std::string_view::npos) {
    return "is not UTF-8 text";
  }
  return fmt::format("is not valid TOML at column {}: {}", error.source().begin.column, line);
}

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

/// A default in the unit of the file, without the noise of dividing by the unit's factor.
double in_file_unit(double si, double scale) {
  const double value = si / scale;
  if (value == 0.0 || !std::isfinite(value)) return value;
  double rounded = 0.0;
  const std::string digits = fmt::format("{:.12e}", value);
  std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
  return rounded;
}

/// What a key may hold, in the words of JSON Schema.
Json number_schema(std::string_view key, const Range& range) {
  Json schema{{"type", "number"}};
  if (const auto unit = unit_words(key); !unit.empty()) schema["description"] = unit;
  if (std::isfinite(range.min)) schema[range.open_min ? "exclusiveMinimum" : "minimum"] = range.min;
  if (std::isfinite(range.max)) schema[range.open_max ? "exclusiveMaximum" : "maximum"] = range.max;
  return schema;
}

Json integer_schema(int min, int max) {
  return {{"type", "integer"}, {"minimum", min}, {"maximum", max}};
}

Json numbers_schema(std::string_view key, int size, const Range& range) {
  return {{"type", "array"},
          {"items", number_schema(key, range)},
          {"minItems", size},
          {"maxItems", size}};
}

/// One of several schemas, each once.
Json any_of(const std::vector<Json>& schemas) {
  Json distinct = Json::array();
  for (const Json& schema : schemas) {
    if (std::find(distinct.begin(), distinct.end(), schema) == distinct.end()) {
      distinct.push_back(schema);
    }
  }
  return distinct.size() == 1 ? distinct[0] : Json{{"anyOf", distinct}};
}

/// The part of a key before its unit, roughly: up to the last underscore.
std::string_view stem(std::string_view key) { return key.substr(0, key.rfind('_')); }

}  // namespace

/// One table with its file, what was asked of it and what was answered.
struct ConfigTable::Node {
  struct Document {
    std::string file;
    std::filesystem::path directory;
    toml::table root;
  };
  using Child = std::shared_ptr<Node>;
  using Answer = std::variant<std::monostate, Json, Child, std::vector<Child>>;

  std::shared_ptr<const Document> document;
  const toml::table* table = nullptr;  // null: absent from the file
  std::string path;                    // "finger[0].waypoint[2]", empty for the root
  std::size_t line = 0;                // 0: unknown
  std::vector<std::pair<std::string, Answer>> asked;
  /// What was asked for, in that order; tables have their own rules.
  struct Rule {
    std::string key;
    bool required;
    Json schema;
    bool any_name = false;
    std::string pattern = {};  // of its name
  };
  std::vector<Rule> rules;

  Rule& rule_of(std::string_view key) {
    const auto known =
        std::find_if(rules.begin(), rules.end(), [&](const Rule& rule) { return rule.key == key; });
    if (known == rules.end()) {
      throw std::logic_error(fmt::format("{}: was not asked for", path_of(key)));
    }
    return *known;
  }
  /// The first rule about a key stands.
  void rule(std::string_view key, bool required, Json schema) {
    const auto known =
        std::find_if(rules.begin(), rules.end(), [&](const Rule& rule) { return rule.key == key; });
    if (known == rules.end()) rules.push_back({std::string(key), required, std::move(schema)});
  }
  Answer& answer(std::string_view key) {
    for (auto& [name, value] : asked) {
      if (name == key) return value;
    }
    return asked.emplace_back(std::string(key), std::monostate{}).second;
  }
  [[nodiscard]] bool is_asked(std::string_view key) const {
    return std::any_of(asked.begin(), asked.end(), [&](const auto& a) { return a.first == key; });
  }
  [[nodiscard]] std::string path_of(std::string_view key) const {
    const std::string name = shown(key);
    if (key.empty()) return path;
    return path.empty() ? name : path + "." + name;
  }
  [[nodiscard]] std::size_t line_of(std::string_view key) const {
    if (table != nullptr) {
      const auto found = table->find(key);
      if (found != table->end()) return found->first.source().begin.line;
    }
    return line;
  }

  /// The value under `key`, null if absent; counts as asking.
  const toml::node* find(std::string_view key) {
    answer(key);
    return table == nullptr ? nullptr : table->get(key);
  }
  const toml::node& require(std::string_view key, std::string_view expected);

  [[noreturn]] void fail(std::size_t at_line, std::string_view at_path,
                         std::string_view message) const {
    std::string text = document->file;
    if (at_line > 0) text += fmt::format(":{}", at_line);
    if (!at_path.empty()) text += fmt::format(": {}", at_path);
    throw InputError(fmt::format("{}: {}", text, message));
  }
  [[noreturn]] void fail(std::string_view key, std::string_view message) const {
    fail(line_of(key), path_of(key), message);
  }
  [[noreturn]] void fail_type(std::string_view key, std::string_view expected,
                              const toml::node& found) const {
    fail(key, fmt::format("expected {}, found {}", expected, describe(found)));
  }

  /// Number in the unit of the file. `name` is the key with an index where it is in an array.
  double checked_number(std::string_view key, std::string_view name, const toml::node& value,
                        const Range& range) const {
    const auto number = value.is_number() ? value.value<double>() : std::nullopt;
    if (!number) {
      fail(line_of(key), path_of(name),
           fmt::format("expected a number, found {}", describe(value)));
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
  double take_number(std::string_view key, const toml::node& value, const Range& range) {
    const double number = checked_number(key, key, value, range);
    answer(key) = value.is_integer() ? Json(value.as_integer()->get()) : Json(number);
    return number * unit_scale(key);
  }
  int take_integer(std::string_view key, const toml::node& value, int min, int max) {
    if (!value.is_integer()) fail_type(key, "a whole number", value);
    const std::int64_t number = value.as_integer()->get();
    if (number < min || number > max) {
      fail(key, fmt::format("must be between {} and {}, found {}", min, max, number));
    }
    answer(key) = Json(number);
    return static_cast<int>(number);
  }
  std::string take_text(std::string_view key, const toml::node& value) {
    if (!value.is_string()) fail_type(key, "a text in quotes", value);
    answer(key) = Json(value.as_string()->get());
    return value.as_string()->get();
  }
  std::filesystem::path take_path(std::string_view key, const toml::node& value) {
    const std::string text = take_text(key, value);
    if (text.empty()) fail(key, "expected a path, found an empty text");
    if (text.find('\0') != std::string::npos) fail(key, "a path cannot contain a zero character");
    return document->directory / text;
  }
  Eigen::VectorXd take_numbers(std::string_view key, const toml::node& value, int size,
                               const Range& range) {
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

  /// The table under `key`; made once, so that all handles share what was asked.
  Child child(std::string_view key, const toml::node* value) {
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
  std::vector<Child> children(std::string_view key, const toml::node* value) {
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

  [[nodiscard]] Json as_read() const {
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

  [[nodiscard]] Json schema_of(const Rule& rule) {
    const Answer& value = answer(rule.key);
    if (const Child* table_node = std::get_if<Child>(&value)) return (*table_node)->schema();
    Json schema = rule.schema;
    if (const auto* list = std::get_if<std::vector<Child>>(&value); list && !list->empty()) {
      std::vector<Json> kinds;
      for (const Child& element : *list) kinds.push_back(element->schema());
      schema["items"] = any_of(kinds);
    }
    return schema;
  }
  [[nodiscard]] Json schema() {
    Json object{{"type", "object"},
                {"properties", Json::object()},
                {"required", Json::array()},
                {"additionalProperties", false}};
    std::map<std::string, std::vector<Json>> of_any_name;  // by the pattern of the name
    for (const Rule& rule : rules) {
      if (rule.any_name) {
        of_any_name[rule.pattern].push_back(schema_of(rule));
        continue;
      }
      if (rule.required) object["required"].push_back(rule.key);
      object["properties"][rule.key] = schema_of(rule);
    }
    if (object["required"].empty()) object.erase("required");
    for (const auto& [pattern, schemas] : of_any_name) {
      if (pattern.empty()) {
        object["additionalProperties"] = any_of(schemas);
      } else {
        object["patternProperties"][pattern] = any_of(schemas);
      }
    }
    return object;
  }

  [[nodiscard]] std::vector<std::string> keys_in_file_order() const {
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
  [[nodiscard]] std::vector<std::string> unasked_keys() const {
    std::vector<std::string> names = keys_in_file_order();
    std::erase_if(names, [&](const std::string& name) { return is_asked(name); });
    return names;
  }
  void finish() const {
    const std::vector<std::string> unknown = unasked_keys();
    if (!unknown.empty()) fail_unknown(unknown.front());
    for (const auto& [key, value] : asked) {
      if (const Child* table_node = std::get_if<Child>(&value)) (*table_node)->finish();
      if (const auto* list = std::get_if<std::vector<Child>>(&value)) {
        for (const Child& element : *list) element->finish();
      }
    }
  }
  [[noreturn]] void fail_unknown(std::string_view key) const {
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
};

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

double ConfigTable::number(std::string_view key, Range range) const {
  node_->rule(key, true, number_schema(key, range));
  return node_->take_number(key, node_->require(key, "a number"), range);
}

double ConfigTable::number(std::string_view key, Range range, double fallback) const {
  node_->rule(key, false, number_schema(key, range));
  if (const toml::node* value = node_->find(key)) return node_->take_number(key, *value, range);
  node_->answer(key) = Json(in_file_unit(fallback, unit_scale(key)));
  return fallback;
}

std::optional<double> ConfigTable::optional_number(std::string_view key, Range range) const {
  node_->rule(key, false, number_schema(key, range));
  const toml::node* value = node_->find(key);
  if (value == nullptr) return std::nullopt;
  return node_->take_number(key, *value, range);
}

int ConfigTable::integer(std::string_view key, int min, int max) const {
  node_->rule(key, true, integer_schema(min, max));
  return node_->take_integer(key, node_->require(key, "a whole number"), min, max);
}

int ConfigTable::integer(std::string_view key, int min, int max, int fallback) const {
  node_->rule(key, false, integer_schema(min, max));
  if (const toml::node* value = node_->find(key)) return node_->take_integer(key, *value, min, max);
  node_->answer(key) = Json(fallback);
  return fallback;
}

bool ConfigTable::boolean(std::string_view key, bool fallback) const {
  node_->rule(key, false, {{"type", "boolean"}});
  bool result = fallback;
  if (const toml::node* value = node_->find(key)) {
    if (!value->is_boolean()) node_->fail_type(key, "true or false", *value);
    result = value->as_boolean()->get();
  }
  node_->answer(key) = Json(result);
  return result;
}

std::string ConfigTable::text(std::string_view key) const {
  node_->rule(key, true, {{"type", "string"}});
  return node_->take_text(key, node_->require(key, "a text in quotes"));
}

std::string ConfigTable::text(std::string_view key, std::string_view fallback) const {
  node_->rule(key, false, {{"type", "string"}});
  if (const toml::node* value = node_->find(key)) return node_->take_text(key, *value);
  node_->answer(key) = Json(std::string(fallback));
  return std::string(fallback);
}

std::optional<std::string> ConfigTable::optional_text(std::string_view key) const {
  node_->rule(key, false, {{"type", "string"}});
  const toml::node* value = node_->find(key);
  if (value == nullptr) return std::nullopt;
  return node_->take_text(key, *value);
}

std::string ConfigTable::choice(std::string_view key,
                                const std::vector<std::string>& choices) const {
  node_->rule(key, true, {{"enum", choices}});
  std::string word = node_->take_text(
      key, node_->require(key, fmt::format("one of {}", fmt::join(choices, ", "))));
  if (std::find(choices.begin(), choices.end(), word) == choices.end()) {
    const std::string nearest = nearest_word(word, choices);
    node_->fail(key, fmt::format("unknown value '{}'; {}expected one of: {}", shown(word),
                                 nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest),
                                 fmt::join(choices, ", ")));
  }
  return word;
}

std::string ConfigTable::choice(std::string_view key, const std::vector<std::string>& choices,
                                std::string_view fallback) const {
  node_->rule(key, false, {{"enum", choices}});
  if (has(key)) return choice(key, choices);
  return text(key, fallback);
}

std::filesystem::path ConfigTable::path(std::string_view key) const {
  node_->rule(key, true, {{"type", "string"}});
  return node_->take_path(key, node_->require(key, "a path in quotes"));
}

std::optional<std::filesystem::path> ConfigTable::optional_path(std::string_view key) const {
  node_->rule(key, false, {{"type", "string"}});
  const toml::node* value = node_->find(key);
  if (value == nullptr) return std::nullopt;
  return node_->take_path(key, *value);
}

Eigen::VectorXd ConfigTable::numbers(std::string_view key, int size, Range range) const {
  node_->rule(key, true, numbers_schema(key, size, range));
  const toml::node& value = node_->require(key, fmt::format("an array of {} numbers", size));
  return node_->take_numbers(key, value, size, range);
}

Eigen::VectorXd ConfigTable::numbers(std::string_view key, int size, Range range,
                                     const Eigen::VectorXd& fallback) const {
  node_->rule(key, false, numbers_schema(key, size, range));
  if (const toml::node* value = node_->find(key)) {
    return node_->take_numbers(key, *value, size, range);
  }
  Json json = Json::array();
  for (const double element : fallback) json.push_back(in_file_unit(element, unit_scale(key)));
  node_->answer(key) = std::move(json);
  return fallback;
}

bool ConfigTable::has(std::string_view key) const {
  return node_->table != nullptr && node_->table->contains(key);
}

std::vector<std::string> ConfigTable::keys() const { return node_->keys_in_file_order(); }

ConfigTable ConfigTable::table(std::string_view key) const {
  node_->rule(key, true, {{"type", "object"}});
  const toml::node& value = node_->require(key, fmt::format("a table, [{}]", node_->path_of(key)));
  return ConfigTable(node_->child(key, &value));
}

ConfigTable ConfigTable::table_or_empty(std::string_view key) const {
  node_->rule(key, false, {{"type", "object"}});
  return ConfigTable(node_->child(key, node_->find(key)));
}

std::optional<ConfigTable> ConfigTable::optional_table(std::string_view key) const {
  node_->rule(key, false, {{"type", "object"}});
  const toml::node* value = node_->find(key);
  if (value == nullptr) return std::nullopt;
  return ConfigTable(node_->child(key, value));
}

std::vector<ConfigTable> ConfigTable::tables(std::string_view key) const {
  node_->rule(key, false, {{"type", "array"}});
  std::vector<ConfigTable> result;
  for (auto& child : node_->children(key, node_->find(key))) result.push_back(ConfigTable(child));
  return result;
}

void ConfigTable::decides(std::string_view key) const {
  if (const Json* read = std::get_if<Json>(&node_->answer(key))) {
    node_->rule_of(key).schema = Json{{"const", *read}};
  }
}

void ConfigTable::any_name(std::string_view key, std::string_view pattern) const {
  ConfigTable::Node::Rule& rule = node_->rule_of(key);
  rule.any_name = true;
  rule.pattern = pattern;
}

void ConfigTable::needs_one(std::string_view key) const {
  ConfigTable::Node::Rule& rule = node_->rule_of(key);
  rule.required = true;
  rule.schema["minItems"] = 1;
}

void ConfigTable::matches(std::string_view key, std::string_view pattern) const {
  node_->rule_of(key).schema["pattern"] = pattern;
}

void ConfigTable::finish() const { node_->finish(); }

void ConfigTable::fail(std::string_view key, std::string_view message) const {
  node_->fail(key, message);
}

ConfigFile::ConfigFile(const std::filesystem::path& file)
    : ConfigFile(file, read_text_file(file, kMaxFileSize)) {}

ConfigFile::ConfigFile(const std::filesystem::path& file, std::string_view text) : file_(file) {
  auto document = std::make_shared<ConfigTable::Node::Document>();
  document->file = file.string();
  document->directory = file.parent_path();
  try {
    document->root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}: {}", document->file, error.source().begin.line,
                                 parse_message(error, text)));
  }
  const toml::table* root = &document->root;
  root_ = std::make_shared<ConfigTable::Node>(ConfigTable::Node{.document = std::move(document),
                                                                .table = root,
                                                                .path = {},
                                                                .line = 0,
                                                                .asked = {},
                                                                .rules = {}});
}

ConfigTable ConfigFile::root() const { return ConfigTable(root_); }

const std::filesystem::path& ConfigFile::file() const { return file_; }

std::string ConfigFile::schema(std::string_view title) const {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  schema.update(root_->schema());
  return schema.dump(2);
}

std::string ConfigFile::as_read() const { return root_->as_read().dump(2); }

}  // namespace softfinger
