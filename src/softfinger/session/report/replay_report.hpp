#pragma once

#include <nlohmann/json.hpp>

#include "softfinger/session/replay.hpp"

namespace softfinger {

/// The fields of `replay --json`.
nlohmann::ordered_json replay_report(const ReplayResult& result);

}  // namespace softfinger
