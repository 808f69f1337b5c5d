#include "softfinger/sensing/force_message.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "softfinger/wire/osc.hpp"

namespace softfinger {
namespace {

constexpr std::string_view kBetween = " \t,;:=";

std::optional<double> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const char* end = word.data() + word.size();
  const auto [rest, failure] = std::from_chars(word.data(), end, value);
  if (failure != std::errc{} || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> decode_force_line(std::string_view line) {
  if (line.size() > kLongestForceLine) return std::nullopt;
  while (true) {
    const std::size_t begin = line.find_first_not_of(kBetween);
    if (begin == std::string_view::npos) return std::nullopt;
    line.remove_prefix(begin);
    const std::string_view word = line.substr(0, line.find_first_of(kBetween));
    if (const auto number = number_of(word)) return number;
    line.remove_prefix(word.size());
  }
}

std::optional<double> decode_force_osc(std::span<const std::uint8_t> packet) {
  std::optional<double> found;
  const bool whole = read_osc(packet, [&](const OscMessage& message) {
    if (message.address != kOscForceAddress) return true;
    std::array<double, 1> number{};
    if (!message.read(number) || !std::isfinite(number[0])) return false;
    found = number[0];
    return true;
  });
  return whole ? found : std::nullopt;
}

std::string encode_force_line(double reading) { return fmt::format("{:.6g}\n", reading); }

std::vector<std::uint8_t> encode_force_osc(double reading) {
  const std::array number{reading};
  std::vector<std::uint8_t> bytes(
      osc_message_size(kOscForceAddress, number.size(), OscNumber::kFloat64));
  OscWriter(bytes).message(kOscForceAddress, number, OscNumber::kFloat64);
  return bytes;
}

}  // namespace softfinger
