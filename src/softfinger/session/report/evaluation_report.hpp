#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "softfinger/session/evaluation.hpp"

namespace softfinger {

/// The fields of `evaluate --json`.
nlohmann::ordered_json evaluation_report(const Evaluation& evaluation);
/// The same for people: means, verdicts and their sources.
std::string evaluation_report_text(const Evaluation& evaluation);

}  // namespace softfinger
