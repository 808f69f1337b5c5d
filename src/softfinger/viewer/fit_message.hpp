#pragma once

#include <string>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

/// A fit of a device to its wearer as clients read it (docs/protocol.md), JSON: type "fit", state
/// ("idle", "waiting", "pressing", "estimating", "saved", "refused"), finger, by_touch, press, of,
/// words, force_N, progress, message.
[[nodiscard]] std::string fit_message(const FitState& state);

}  // namespace softfinger
