#pragma once

#include <optional>
#include <string_view>

namespace softfinger {

enum class HandSide { kRight, kLeft };
enum class HandFinger { kThumb, kIndex, kMiddle, kRing, kPinky };

/// "right" or "left".
[[nodiscard]] std::string_view name_of(HandSide side);
/// "thumb", "index", "middle", "ring" or "pinky".
[[nodiscard]] std::string_view name_of(HandFinger finger);
[[nodiscard]] std::optional<HandFinger> hand_finger_of(std::string_view name);

/// What a finger follows of a tracked hand.
struct HandPart {
  HandSide side = HandSide::kRight;
  std::optional<HandFinger> finger = {};  ///< empty: which one is left to the scene
};

/// "SIDE", "FINGER" or "SIDE-FINGER"; empty where it is anything else.
[[nodiscard]] std::optional<HandPart> parse_hand_part(std::string_view text);

}  // namespace softfinger
