#include "softfinger/session/report/replay_report.hpp"

namespace softfinger {

nlohmann::ordered_json replay_report(const ReplayResult& result) {
  nlohmann::ordered_json report{{"agree", result.agree},
                                {"steps", result.steps},
                                {"complete", result.cut.empty()},
                                {"first_difference", nullptr},
                                {"difference", nullptr}};
  if (result.first_difference) {
    report["first_difference"] = *result.first_difference;
    report["difference"] = result.difference;
  }
  return report;
}

}  // namespace softfinger
