#pragma once

#include <optional>
#include <string_view>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

/// Reads a hand as the page sends it in every frame of a headset, a binary message, little-endian:
/// u32 0x58484653 ("SFHX"), u32 flags (1: tracked, 2: the left hand), f64 time (ms, the page's
/// performance.now) and, where tracked, 25 joints of eight f32: position x, y, z (m), quaternion x,
/// y, z, w, radius (m). Empty where it is anything else: another length or flag, a number that is
/// not finite, a time below zero or over 100 years, a position more than 10 m from the origin in a
/// coordinate, a quaternion whose length is not 1 within 1 %, a radius out of [0, 0.1] m.
[[nodiscard]] std::optional<XrHand> parse_hand_message(std::string_view message);

}  // namespace softfinger
