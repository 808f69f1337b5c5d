#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

/// What happened to objects of a scene: {"type": "events", "generation": 1, "events": [...]}.
[[nodiscard]] std::string events_message(std::uint64_t generation,
                                         std::span<const LiveEvent> events);

}  // namespace softfinger
