#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace softfinger {

/// Interval of numbers a key may take, in the unit of the file (as its user reads it).
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;
  bool open_max = false;

  static Range any() { return {}; }
  static Range positive() { return {.min = 0.0, .open_min = true}; }
  static Range at_least(double low) { return {.min = low}; }
  static Range between(double low, double high) { return {.min = low, .max = high}; }
  static Range inside(double low, double high) {
    return {.min = low, .max = high, .open_min = true, .open_max = true};
  }
};

/// One table of a TOML file, read strictly. Every getter converts from the unit in the key's suffix
/// to SI (see unit_scale), refuses NaN, infinity, a wrong type and a number out of range, and
/// throws InputError with file, line and key. finish() refuses keys that nobody asked for and names
/// the nearest known one. Missing required keys are refused. What was read, defaults filled in and
/// paths as written, is kept as JSON for `show`.
///
/// A cheap handle; it keeps its file alive.
class ConfigTable {
 public:
  /// Required number, in SI.
  double number(std::string_view key, Range range = Range::any()) const;
  /// Number with a default; `fallback` and the result are in SI.
  double number(std::string_view key, Range range, double fallback) const;
  std::optional<double> optional_number(std::string_view key, Range range = Range::any()) const;

  int integer(std::string_view key, int min, int max) const;
  int integer(std::string_view key, int min, int max, int fallback) const;
  bool boolean(std::string_view key, bool fallback) const;

  std::string text(std::string_view key) const;
  std::string text(std::string_view key, std::string_view fallback) const;
  std::optional<std::string> optional_text(std::string_view key) const;
  /// Text, or a whole number between min and max, which comes back as its digits.
  std::string text_or_integer(std::string_view key, int min, int max,
                              std::string_view fallback) const;
  /// Text that must be one of `choices`.
  std::string choice(std::string_view key, const std::vector<std::string>& choices) const;
  std::string choice(std::string_view key, const std::vector<std::string>& choices,
                     std::string_view fallback) const;
  /// Array of at least one text, each in quotes.
  std::vector<std::string> texts(std::string_view key) const;
  /// A path as text, relative to the file that names it; existence is not checked.
  std::filesystem::path path(std::string_view key) const;
  std::optional<std::filesystem::path> optional_path(std::string_view key) const;

  /// Array of exactly `size` numbers, in SI.
  Eigen::VectorXd numbers(std::string_view key, int size, Range range = Range::any()) const;
  Eigen::VectorXd numbers(std::string_view key, int size, Range range,
                          const Eigen::VectorXd& fallback) const;
  std::optional<Eigen::VectorXd> optional_numbers(std::string_view key, int size,
                                                  Range range = Range::any()) const;
  /// Array of as many numbers as it has, from `least` to `most`, in SI.
  Eigen::VectorXd some_numbers(std::string_view key, int least, int most,
                               Range range = Range::any()) const;

  /// Whether the file has the key (does not count as asking for it).
  [[nodiscard]] bool has(std::string_view key) const;
  /// Whether it has it, as a table (does not count as asking either).
  [[nodiscard]] bool has_table(std::string_view key) const;
  /// Names of all keys of this table, in file order.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Required sub-table.
  ConfigTable table(std::string_view key) const;
  /// Sub-table that reads as empty (defaults only) when absent.
  ConfigTable table_or_empty(std::string_view key) const;
  std::optional<ConfigTable> optional_table(std::string_view key) const;
  /// Array of tables `[[key]]`; empty when absent.
  std::vector<ConfigTable> tables(std::string_view key) const;

  // What the schema of the file cannot see of its reader; without effect on reading.

  /// Which other keys there are depends on this one, a choice or a boolean that was read: it is a
  /// constant in the schema of this table.
  void decides(std::string_view key) const;
  /// The name of this key, which was asked for, is the file's own choice: any that matches the
  /// regular expression stands for it, any but the table's other keys where there is none.
  void any_name(std::string_view key, std::string_view pattern = {}) const;
  /// The array of tables of this key, which was asked for, is required and not empty.
  void needs_one(std::string_view key) const;
  /// The text of this key, which was asked for, matches a regular expression.
  void matches(std::string_view key, std::string_view pattern) const;

  /// Throws InputError for the first key nobody asked for, in this table and the tables taken from
  /// it.
  void finish() const;
  /// Throws InputError "file:line: key: message". An empty key speaks of the table itself.
  [[noreturn]] void fail(std::string_view key, std::string_view message) const;

 private:
  friend class ConfigFile;
  struct Node;
  explicit ConfigTable(std::shared_ptr<Node> node) : node_(std::move(node)) {}
  std::shared_ptr<Node> node_;
};

/// A TOML file opened for strict reading.
class ConfigFile {
 public:
  static constexpr std::size_t kMaxSize = std::size_t{4} << 20;  ///< bytes

  /// Throws InputError when the file cannot be read or is not TOML.
  explicit ConfigFile(const std::filesystem::path& file);
  /// The same of a text at hand; messages name `file`, which need not exist.
  ConfigFile(const std::filesystem::path& file, std::string_view text);
  [[nodiscard]] ConfigTable root() const;
  [[nodiscard]] const std::filesystem::path& file() const;
  /// All that was read so far as a JSON object text: the file's keys and nesting in the order they
  /// were asked for, in the file's units, defaults filled in, paths as written.
  [[nodiscard]] std::string as_read() const;
  /// What was asked of the file so far as a JSON Schema: keys, types and ranges in the file's
  /// units, which are required; no others are allowed.
  [[nodiscard]] std::string schema(std::string_view title) const;

 private:
  std::filesystem::path file_;
  std::shared_ptr<ConfigTable::Node> root_;
};

/// Of `candidates`, the one nearest to `word` by edit distance; empty if none is near.
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       const std::vector<std::string>& candidates);

}  // namespace softfinger
