#pragma once

#include <span>
#include <string>

namespace softfinger {

/// What people are told on the page as on the terminal: {"type": "notifications", "lines": [...]}.
[[nodiscard]] std::string notification_message(std::span<const std::string> lines);

}  // namespace softfinger
