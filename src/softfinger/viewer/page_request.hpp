#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "softfinger/engine/live_feed.hpp"

namespace softfinger {

/// Reads a message of the page, strictly: {"request": "pause" | "resume" | "restart"} or
/// {"request": "scene", "scene": NAME} with NAME one of `scene_names`, and no other key. Empty
/// where it is anything else.
[[nodiscard]] std::optional<LiveRequest> parse_page_request(
    std::string_view message, std::span<const std::string> scene_names);

}  // namespace softfinger
