#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

/// Reads a message of the page, strictly: {"request": "pause" | "resume" | "restart" | "stop"},
/// {"request": "release", "generation": N, "stops": N} with what the newest snapshot said,
/// {"request": "scene", "scene": NAME} with NAME one of `scene_names`, or
/// {"request": "objective", "finger": INDEX, "objective": NAME} with 1 to 64 bytes of NAME, or
/// {"request": "pose", "finger": INDEX, "position_mm": [x, y, z], "quaternion": [w, x, y, z]} with
/// X_WFt within a metre of the origin and a quaternion of length 1 within 1 %, or
/// {"request": "register", "finger": INDEX} with any of "length_mm", "breadth_mm", "depth_mm" (1 to
/// 500) and "table_mm" (-5000 to 5000), {"request": "cancel_registration"},
/// {"request": "fit", "finger": INDEX} with or without "again" (true or false),
/// {"request": "cancel_fit"}, {"request": "felt"}, and no other key.
/// Empty where it is anything else.
[[nodiscard]] std::optional<LiveRequest> parse_page_request(
    std::string_view message, std::span<const std::string> scene_names);

}  // namespace softfinger
