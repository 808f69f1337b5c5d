#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "softfinger/base/name_table.hpp"

namespace softfinger {

enum class HandSide { kRight, kLeft };
enum class HandFinger { kThumb, kIndex, kMiddle, kRing, kPinky };
inline constexpr std::array<NameRow<HandSide>, 2> kHandSides{{
    {HandSide::kRight, "right"},
    {HandSide::kLeft, "left"},
}};
inline constexpr std::array<NameRow<HandFinger>, 5> kHandFingers{{
    {HandFinger::kThumb, "thumb"},
    {HandFinger::kIndex, "index"},
    {HandFinger::kMiddle, "middle"},
    {HandFinger::kRing, "ring"},
    {HandFinger::kPinky, "pinky"},
}};

/// "right" or "left".
[[nodiscard]] constexpr std::string_view name_of(HandSide side) {
  return row_of(kHandSides, side).name;
}
/// "thumb", "index", "middle", "ring" or "pinky".
[[nodiscard]] constexpr std::string_view name_of(HandFinger finger) {
  return row_of(kHandFingers, finger).name;
}
[[nodiscard]] std::optional<HandFinger> hand_finger_of(std::string_view name);

/// What a finger follows of a tracked hand.
struct HandPart {
  HandSide side = HandSide::kRight;
  std::optional<HandFinger> finger = {};  ///< empty: which one is left to the scene
};

/// "SIDE", "FINGER" or "SIDE-FINGER"; empty where it is anything else.
[[nodiscard]] std::optional<HandPart> parse_hand_part(std::string_view text);

}  // namespace softfinger
