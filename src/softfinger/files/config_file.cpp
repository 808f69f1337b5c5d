#include "softfinger/files/config_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config/config_node.hpp"
#include "softfinger/files/config/config_schema.hpp"
#include "softfinger/files/text_file.hpp"

namespace softfinger {
namespace {

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

/// A default in the unit of the file, without the noise of dividing by the unit's factor.
double in_file_unit(double si, double scale) {
  const double value = si / scale;
  if (value == 0.0 || !std::isfinite(value)) return value;
  double rounded = 0.0;
  const std::string digits = fmt::format("{:.12e}", value);
  std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
  return rounded;
}

}  // namespace

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

std::string ConfigTable::text_or_integer(std::string_view key, int min, int max,
                                         std::string_view fallback) const {
  node_->rule(key, false, {{"anyOf", {{{"type", "string"}}, integer_schema(min, max)}}});
  const toml::node* value = node_->find(key);
  if (value != nullptr && value->is_integer()) {
    return fmt::format("{}", node_->take_integer(key, *value, min, max));
  }
  return text(key, fallback);
}

std::optional<std::string> ConfigTable::optional_text(std::string_view key) const {
  node_->rule(key, false, {{"type", "string"}});
  const toml::node* value = node_->find(key);
  if (value == nullptr) return std::nullopt;
  return node_->take_text(key, *value);
}

std::vector<std::string> ConfigTable::texts(std::string_view key) const {
  node_->rule(key, true, {{"type", "array"}, {"items", {{"type", "string"}}}, {"minItems", 1}});
  const std::string expected = "an array of texts in quotes";
  const toml::node& value = node_->require(key, expected);
  const toml::array* array = value.as_array();
  if (array == nullptr || array->empty()) node_->fail_type(key, expected, value);
  std::vector<std::string> texts;
  Json json = Json::array();
  for (const toml::node& element : *array) {
    if (!element.is_string()) node_->fail_type(key, expected, value);
    texts.push_back(element.as_string()->get());
    json.push_back(texts.back());
  }
  node_->answer(key) = std::move(json);
  return texts;
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

std::optional<Eigen::VectorXd> ConfigTable::optional_numbers(std::string_view key, int size,
                                                             Range range) const {
  node_->rule(key, false, numbers_schema(key, size, range));
  const toml::node* value = node_->find(key);
  if (value == nullptr) return std::nullopt;
  return node_->take_numbers(key, *value, size, range);
}

Eigen::VectorXd ConfigTable::some_numbers(std::string_view key, int least, int most,
                                          Range range) const {
  Json schema = numbers_schema(key, most, range);
  schema["minItems"] = least;
  node_->rule(key, true, schema);
  const std::string expected = fmt::format("an array of {} to {} numbers", least, most);
  const toml::node& value = node_->require(key, expected);
  const toml::array* const array = value.as_array();
  const int size =
      array != nullptr ? static_cast<int>(std::min<std::size_t>(array->size(), 1000000)) : -1;
  if (size < least || size > most) node_->fail_type(key, expected, value);
  return node_->take_numbers(key, value, size, range);
}

bool ConfigTable::has(std::string_view key) const {
  return node_->table != nullptr && node_->table->contains(key);
}

bool ConfigTable::has_table(std::string_view key) const {
  return has(key) && node_->table->get(key)->is_table();
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
    : ConfigFile(file, read_text_file(file, kMaxSize)) {}

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
