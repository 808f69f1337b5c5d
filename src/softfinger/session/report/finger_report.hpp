#pragma once

#include <nlohmann/json.hpp>

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// What `finger show --json` prints: the file's keys, defaults filled in, and `mesh_statistics`.
nlohmann::ordered_json finger_report(const FingerModel& model);

}  // namespace softfinger
