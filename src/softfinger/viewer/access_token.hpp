#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace softfinger {

/// The secret that visitors from other machines must know. Compared in a time that does not tell
/// how much of a guess is right.
class AccessToken {
 public:
  static constexpr std::size_t kShortest = 16;
  static constexpr std::size_t kLongest = 128;

  /// The only line of a file: kShortest to kLongest letters, digits, - and _, readable by its owner
  /// alone. Throws InputError naming --token and the file.
  static AccessToken read(const std::filesystem::path& file);
  /// Nothing is asked for.
  AccessToken() = default;

  [[nodiscard]] bool is_needed() const { return !text_.empty(); }
  [[nodiscard]] bool matches(std::string_view guess) const;
  /// Whether the query of a request's target, "/?token=...", has it.
  [[nodiscard]] bool is_in_target(std::string_view target) const;
  /// Whether a Cookie header has it, under kCookie.
  [[nodiscard]] bool is_in_cookies(std::string_view header) const;
  [[nodiscard]] const std::string& text() const { return text_; }

  static constexpr std::string_view kCookie = "softfinger-token";

 private:
  std::string text_;
};

}  // namespace softfinger
