#pragma once

#include <string>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

/// A registration as clients read it (docs/protocol.md), JSON: type "registration", state
/// ("idle", "running", "saved", "refused"), finger, held, of, posture, words (how to hold it),
/// progress in twentieths, message.
[[nodiscard]] std::string registration_message(const RegistrationState& state);

}  // namespace softfinger
