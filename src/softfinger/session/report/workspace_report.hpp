#pragma once

#include <nlohmann/json.hpp>

#include "softfinger/device/workspace.hpp"

namespace softfinger {

/// The fields of `device workspace --json`.
nlohmann::ordered_json workspace_report(const WorkspaceSummary& workspace);

}  // namespace softfinger
