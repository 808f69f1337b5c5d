#include "softfinger/tracking/hand_part.hpp"

#include <cstddef>

namespace softfinger {
namespace {

std::optional<HandSide> hand_side_of(std::string_view name) {
  const auto* const row = row_named(kHandSides, name);
  return row == nullptr ? std::nullopt : std::optional(row->value);
}

}  // namespace

std::optional<HandFinger> hand_finger_of(std::string_view name) {
  const auto* const row = row_named(kHandFingers, name);
  return row == nullptr ? std::nullopt : std::optional(row->value);
}

std::optional<HandPart> parse_hand_part(std::string_view text) {
  const std::size_t dash = text.find('-');
  const auto side = hand_side_of(text.substr(0, dash));
  if (dash == std::string_view::npos) {
    const auto finger = hand_finger_of(text);
    if (!side && !finger) return {};
    return HandPart{side.value_or(HandSide::kRight), finger};
  }
  const auto finger = hand_finger_of(text.substr(dash + 1));
  if (!side || !finger) return {};
  return HandPart{*side, finger};
}

}  // namespace softfinger
