#include "softfinger/motors/weart/weart_protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace softfinger {
namespace {

constexpr std::size_t kMostFields = 8;

struct Fields {
  std::array<std::string_view, kMostFields> text;
  std::size_t count = 0;
};

std::optional<Fields> split_fields(std::string_view message) {
  Fields fields;
  while (true) {
    if (fields.count == kMostFields) return std::nullopt;
    const std::size_t colon = message.find(':');
    fields.text[fields.count++] = message.substr(0, colon);
    if (colon == std::string_view::npos) return fields;
    message.remove_prefix(colon + 1);
  }
}

bool is_hand(std::string_view text) { return text == "LEFT" || text == "RIGHT"; }

bool is_point(std::string_view text) {
  constexpr std::array<std::string_view, 6> kPoints{"THUMB",   "INDEX", "MIDDLE",
                                                    "ANNULAR", "PINKY", "PALM"};
  return std::find(kPoints.begin(), kPoints.end(), text) != kPoints.end();
}

/// From 0 to 1, written plainly.
std::optional<double> read_part(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!(value >= 0.0 && value <= 1.0)) return std::nullopt;
  return value;
}

std::optional<WeartRequest> read_request(std::string_view message) {
  const auto fields = split_fields(message);
  if (!fields) return std::nullopt;
  const auto& text = fields->text;
  WeartRequest request;
  const auto addressed_by = [&](std::size_t hand) {
    if (fields->count != hand + 2 || !is_hand(text[hand]) || !is_point(text[hand + 1])) {
      return false;
    }
    request.address = fmt::format("{}:{}", text[hand], text[hand + 1]);
    return true;
  };
  if (text[0] == "StartFromClient") {
    request.kind = WeartRequest::Kind::kStart;
  } else if (text[0] == "StopFromClient") {
    request.kind = WeartRequest::Kind::kStop;
  } else if (text[0] == "stopForce") {
    request.kind = WeartRequest::Kind::kStopForce;
    if (!addressed_by(1)) return std::nullopt;
  } else if (text[0] == "force") {
    request.kind = WeartRequest::Kind::kForce;
    if (!addressed_by(4)) return std::nullopt;
    const auto force = read_part(text[1]);
    if (!force || !read_part(text[2]) || !read_part(text[3])) return std::nullopt;
    request.force = *force;
  } else if (text[0].empty()) {
    return std::nullopt;
  }
  return request;
}

}  // namespace

std::string weart_start() { return "StartFromClient:softfinger:1.0.0:TrackType1~"; }

std::string_view weart_stop() { return "StopFromClient~"; }

std::size_t encode_weart_force(double force, std::string_view address, std::span<char> out) {
  const auto end = fmt::format_to_n(out.data(), out.size(), "force:{:.6f}:0.000000:0.000000:{}~",
                                    force, address);
  return end.size <= out.size() ? end.size : 0;
}

std::size_t encode_weart_stop_force(std::string_view address, std::span<char> out) {
  const auto end = fmt::format_to_n(out.data(), out.size(), "stopForce:{}~", address);
  return end.size <= out.size() ? end.size : 0;
}

std::optional<WeartRequest> WeartReader::push(std::uint8_t byte) {
  const char letter = static_cast<char>(byte);
  if (letter != '~') {
    if (size_ == kLongest) {
      too_long_ = true;
    } else {
      text_[size_++] = letter;
    }
    return std::nullopt;
  }
  auto request = too_long_ ? std::nullopt : read_request({text_.data(), size_});
  if (!request) ++malformed_;
  size_ = 0;
  too_long_ = false;
  return request;
}

}  // namespace softfinger
