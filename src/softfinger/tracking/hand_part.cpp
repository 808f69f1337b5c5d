#include "softfinger/tracking/hand_part.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace softfinger {
namespace {

constexpr std::array<std::string_view, 2> kSideNames{"right", "left"};
constexpr std::array<std::string_view, 5> kHandFingerNames{"thumb", "index", "middle", "ring",
                                                           "pinky"};

/// The enumerator whose name is `word`; empty where none is.
template <typename Enum, std::size_t count>
std::optional<Enum> named(const std::array<std::string_view, count>& names, std::string_view word) {
  const auto* const at = std::ranges::find(names, word);
  if (at == names.end()) return {};
  return static_cast<Enum>(at - names.begin());
}

}  // namespace

std::string_view name_of(HandSide side) { return kSideNames.at(static_cast<std::size_t>(side)); }

std::string_view name_of(HandFinger finger) {
  return kHandFingerNames.at(static_cast<std::size_t>(finger));
}

std::optional<HandFinger> hand_finger_of(std::string_view name) {
  return named<HandFinger>(kHandFingerNames, name);
}

std::optional<HandPart> parse_hand_part(std::string_view text) {
  const std::size_t dash = text.find('-');
  const auto side = named<HandSide>(kSideNames, text.substr(0, dash));
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
