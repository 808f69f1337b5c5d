#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "softfinger/session/run_summary.hpp"

namespace softfinger {

/// The fields of `run --json`.
nlohmann::ordered_json run_report(const RunSummary& summary);
/// The same for people, several lines.
std::string run_report_text(const RunSummary& summary);
/// What people must know of a device: [{key, text}].
nlohmann::ordered_json notices_json(const std::vector<DeviceNotice>& notices);

}  // namespace softfinger
