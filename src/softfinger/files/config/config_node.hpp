#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "softfinger/files/config_file.hpp"

namespace softfinger {

using Json = nlohmann::ordered_json;

/// Text as part of a one-line message: no control characters, not endless.
[[nodiscard]] std::string shown(std::string_view text);

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

  Rule& rule_of(std::string_view key);
  /// The first rule about a key stands.
  void rule(std::string_view key, bool required, Json schema);
  Answer& answer(std::string_view key);
  [[nodiscard]] bool is_asked(std::string_view key) const;
  [[nodiscard]] std::string path_of(std::string_view key) const;
  [[nodiscard]] std::size_t line_of(std::string_view key) const;

  /// The value under `key`, null if absent; counts as asking.
  const toml::node* find(std::string_view key);
  const toml::node& require(std::string_view key, std::string_view expected);

  [[noreturn]] void fail(std::size_t at_line, std::string_view at_path,
                         std::string_view message) const;
  [[noreturn]] void fail(std::string_view key, std::string_view message) const;
  [[noreturn]] void fail_type(std::string_view key, std::string_view expected,
                              const toml::node& found) const;

  /// Number in the unit of the file. `name` is the key with an index where it is in an array.
  double checked_number(std::string_view key, std::string_view name, const toml::node& value,
                        const Range& range) const;
  double take_number(std::string_view key, const toml::node& value, const Range& range);
  int take_integer(std::string_view key, const toml::node& value, int min, int max);
  std::string take_text(std::string_view key, const toml::node& value);
  std::filesystem::path take_path(std::string_view key, const toml::node& value);
  Eigen::VectorXd take_numbers(std::string_view key, const toml::node& value, int size,
                               const Range& range);

  /// The table under `key`; made once, so that all handles share what was asked.
  Child child(std::string_view key, const toml::node* value);
  std::vector<Child> children(std::string_view key, const toml::node* value);

  [[nodiscard]] Json as_read() const;

  [[nodiscard]] Json schema_of(const Rule& rule);
  [[nodiscard]] Json schema();

  [[nodiscard]] std::vector<std::string> keys_in_file_order() const;
  [[nodiscard]] std::vector<std::string> unasked_keys() const;
  void finish() const;
  [[noreturn]] void fail_unknown(std::string_view key) const;
};

}  // namespace softfinger
