#include "softfinger/session/report/device_fit_report.hpp"

#include <string>

#include "softfinger/base/units.hpp"
#include "softfinger/session/report/rounded.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json device_fit_report(const DeviceFit& fit) {
  Json answer{{"by", fit.by_touch ? "touches" : "presses"},
              {"presses", fit.presses},
              {"duration_s", micro_rounded(fit.duration)},
              {"max_force_N", micro_rounded(fit.greatest_force)},
              {"sensor_noise_N", micro_rounded(fit.noise)},
              {"parameters", Json::object()},
              {"at_prior", Json::array()},
              {"known_force_error", nullptr},
              {"predicted_force_error", nullptr},
              {"registration", nullptr},
              {"written", nullptr},
              {"failure", nullptr}};
  for (const DeviceFit::Told& told : fit.traits) {
    const WearerTraitRow& row = row_of(kWearerTraitRows, told.trait);
    answer["parameters"][std::string(row.name)] = {
        {"value", micro_rounded(told.value / row.unit)},
        {"ci95_low", micro_rounded(told.ci95_low / row.unit)},
        {"ci95_high", micro_rounded(told.ci95_high / row.unit)},
        {"prior", micro_rounded(told.prior / row.unit)}};
    if (!fit.estimate.is_told(told.trait)) answer["at_prior"].push_back(row.name);
  }
  if (!fit.traits.empty()) {
    answer["known_force_error"] = micro_rounded(fit.estimate.known_force_error);
    answer["predicted_force_error"] = micro_rounded(fit.estimate.predicted_force_error);
  }
  if (fit.by_touch && !fit.traits.empty()) {
    answer["touch_deviation_mm"] = micro_rounded(fit.estimate.touch_deviation / mm);
  }
  if (fit.registration) {
    const Pose& X_BodyFt = fit.registration->X_BodyFt;
    answer["registration"] = {
        {"translation_mm", micro_rounded(X_BodyFt.translation, mm)},
        {"rotation_vector_deg", micro_rounded(log_rotation(X_BodyFt.rotation), deg)},
        {"moved_mm", micro_rounded(fit.registration_moved / mm)},
        {"height_residual_mm", micro_rounded(fit.registration->height_residual / mm)}};
  }
  if (!fit.registration_failure.empty()) answer["registration_failure"] = fit.registration_failure;
  if (!fit.written.empty()) answer["written"] = fit.written.string();
  if (!fit.failure.empty()) answer["failure"] = fit.failure;
  return answer;
}

}  // namespace softfinger
