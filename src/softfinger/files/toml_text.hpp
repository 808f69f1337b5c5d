#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softfinger {

/// The text of a TOML file in which numbers can be replaced by others. All the rest, comments and
/// lines included, stays as it is, so that what a reader says of a changed text still names lines
/// of the file.
///
/// A number is told by the way to its key: "geometry.crank_mm"; an element of an array by its
/// place from 0, "mount.translation_mm.2"; one of several tables by that or by its `name`,
/// "object.ball.radius_mm".
class TomlText {
 public:
  /// `file` is for messages. Throws InputError where the text is not TOML.
  TomlText(const std::filesystem::path& file, std::string text);

  [[nodiscard]] const std::string& text() const { return text_; }
  /// Empty: there is no such number, in the text or added.
  [[nodiscard]] std::optional<double> number(std::string_view way) const;
  /// Whether these are two ways to one number.
  [[nodiscard]] bool is_same(std::string_view way, std::string_view other) const;
  /// The ways to all numbers, in no order of note.
  [[nodiscard]] std::vector<std::string> ways() const;

  /// All values that are texts.
  [[nodiscard]] const std::vector<std::string>& words() const { return words_; }

  /// From now on there is a number here, `value` where nothing else is said: for a key that the
  /// file leaves out. False where the text has no place for it: its table is written inline, or is
  /// one of several that are not there.
  bool add(std::string_view way, double value);

  /// The text with these numbers, each of which is there, instead of its own.
  [[nodiscard]] std::string with(const std::vector<std::pair<std::string, double>>& numbers) const;

 private:
  struct Place {
    std::string way;
    std::size_t begin = 0, end = 0;  ///< of the number in the text; the same: it is put in
    std::string before, after;       ///< put in with it
    double value = 0.0;
  };
  /// Where a table's keys may follow.
  struct Table {
    std::string way;
    std::size_t line_end = 0;  ///< after its heading
  };

  [[nodiscard]] const Place* find(std::string_view way) const;

  std::string text_;
  std::vector<Place> places_;
  std::vector<std::string> words_;
  std::vector<Table> tables_;        ///< with a heading of their own
  std::vector<std::string> others_;  ///< ways to all that is there and no table of those
};

}  // namespace softfinger
