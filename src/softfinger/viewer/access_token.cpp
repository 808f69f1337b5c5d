#include "softfinger/viewer/access_token.hpp"

#include <fmt/core.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

bool is_token_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

/// The next piece of `rest` before `separator`, which is taken off.
std::string_view next_piece(std::string_view& rest, char separator) {
  const std::size_t end = std::min(rest.find(separator), rest.size());
  const std::string_view piece = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return piece;
}

/// In a time that depends on the secret's length alone.
bool is_same(std::string_view secret, std::string_view guess) {
  unsigned difference = guess.size() == secret.size() ? 0U : 1U;
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const char c = i < guess.size() ? guess[i] : '\0';
    difference |= static_cast<unsigned char>(c ^ secret[i]);
  }
  return difference == 0;
}

}  // namespace

AccessToken AccessToken::read(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  const auto refuse = [&](std::string_view what) {
    throw InputError(fmt::format("--token {}: {}", file.string(), what));
  };
  std::ifstream stream(file);
  if (!stream) refuse("cannot be read");
  std::string line(kLongest + 2, '\0');
  stream.read(line.data(), static_cast<std::streamsize>(line.size()));
  line.resize(static_cast<std::size_t>(stream.gcount()));
  if (!line.empty() && line.back() == '\n') line.pop_back();
  if (line.size() < kShortest || line.size() > kLongest ||
      !std::all_of(line.begin(), line.end(), is_token_character)) {
    refuse(
        fmt::format("expected one line of {} to {} letters, digits, - or _", kShortest, kLongest));
  }
  const fs::perms others = fs::perms::group_all | fs::perms::others_all;
  std::error_code error;
  if ((fs::status(file, error).permissions() & others) != fs::perms::none) {
    refuse("others may read it; chmod 600");
  }
  AccessToken token;
  token.text_ = line;
  return token;
}

bool AccessToken::matches(std::string_view guess) const { return is_same(text_, guess); }

bool AccessToken::is_in_target(std::string_view target) const {
  const std::size_t question = target.find('?');
  if (question == std::string_view::npos) return false;
  constexpr std::string_view kKey = "token=";
  std::string_view rest = target.substr(question + 1);
  while (!rest.empty()) {
    const std::string_view piece = next_piece(rest, '&');
    if (piece.starts_with(kKey) && matches(piece.substr(kKey.size()))) return true;
  }
  return false;
}

VisitorCookie::VisitorCookie() {
  std::array<std::uint64_t, 4> random{};
  if (::getrandom(random.data(), sizeof random, 0) != static_cast<ssize_t>(sizeof random)) {
    throw OperationError("no random numbers to know visitors of the page by");
  }
  for (const std::uint64_t word : random) value_ += fmt::format("{:016x}", word);
}

std::string VisitorCookie::name(std::uint16_t port) { return fmt::format("softfinger-{}", port); }

bool VisitorCookie::is_in(std::string_view header, std::uint16_t port) const {
  const std::string wanted = name(port);
  std::string_view rest = header;
  while (!rest.empty()) {
    std::string_view piece = next_piece(rest, ';');
    while (piece.starts_with(' ')) piece.remove_prefix(1);
    if (next_piece(piece, '=') == wanted && is_same(value_, piece)) return true;
  }
  return false;
}

}  // namespace softfinger
