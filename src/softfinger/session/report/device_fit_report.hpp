#pragma once

#include <nlohmann/json.hpp>

#include "softfinger/session/device_fit.hpp"

namespace softfinger {

/// The fields of `device fit --json`.
nlohmann::ordered_json device_fit_report(const DeviceFit& fit);

}  // namespace softfinger
