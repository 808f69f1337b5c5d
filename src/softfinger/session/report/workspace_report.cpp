#include "softfinger/session/report/workspace_report.hpp"

#include "softfinger/base/units.hpp"

namespace softfinger {

nlohmann::ordered_json workspace_report(const WorkspaceSummary& workspace) {
  if (workspace.reaches.empty()) {
    return {{"travel_mm", {workspace.min_travel / mm, workspace.max_travel / mm}},
            {"mid_travel_mm", workspace.mid_travel / mm},
            {"min_tilt_at_mid_travel_deg", workspace.min_tilt_at_mid_travel / deg},
            {"max_tilt_deg", workspace.max_tilt / deg}};
  }
  nlohmann::ordered_json report = nlohmann::ordered_json::object();
  for (const AxisReach& reach : workspace.reaches) {
    report[reach.name] = {reach.min / reach.unit, reach.max / reach.unit};
  }
  return report;
}

}  // namespace softfinger
