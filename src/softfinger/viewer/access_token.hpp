#pragma once

#include <cstdint>
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
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// What visitors who had the token show from then on: drawn anew by each server, so that neither a
/// browser nor who reads its files learns the token.
class VisitorCookie {
 public:
  /// Throws OperationError where the system has no random numbers.
  VisitorCookie();

  /// Browsers send a cookie to all ports of a host: each has a name of its own.
  [[nodiscard]] static std::string name(std::uint16_t port);
  [[nodiscard]] const std::string& value() const { return value_; }
  /// Whether a Cookie header has it, under the name for this port.
  [[nodiscard]] bool is_in(std::string_view header, std::uint16_t port) const;

 private:
  std::string value_;
};

}  // namespace softfinger
