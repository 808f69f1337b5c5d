#pragma once

#include <span>
#include <string>
#include <string_view>

namespace softfinger {

/// What people are told on the page as on the terminal: {"type": "notifications", "lines": [...]}.
[[nodiscard]] std::string notification_message(std::span<const std::string> lines);

/// Which scene is on its way in place of the one shown, "" for none: {"type": "loading", "scene":
/// "hand"}.
[[nodiscard]] std::string loading_message(std::string_view scene);

}  // namespace softfinger
