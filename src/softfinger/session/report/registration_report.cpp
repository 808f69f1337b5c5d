#include "softfinger/session/report/registration_report.hpp"

#include "softfinger/base/units.hpp"
#include "softfinger/session/report/rounded.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

Json size_json(const std::optional<double>& size) {
  return size ? Json(micro_rounded(*size / mm)) : Json(nullptr);
}

}  // namespace

Json registration_report(const std::filesystem::path& person,
                         const FingerRegistration& registered) {
  const FingerSize& size = registered.finger.size;
  Json report{{"person", person.string()},           {"finger", registered.finger.name},
              {"length_mm", size_json(size.length)}, {"breadth_mm", size_json(size.breadth)},
              {"depth_mm", size_json(size.depth)},   {"translation_mm", nullptr},
              {"rotation_vector_deg", nullptr},      {"table_height_mm", nullptr},
              {"height_residual_mm", nullptr},       {"turn_residual_deg", nullptr}};
  if (const auto& found = registered.found) {
    report["translation_mm"] = micro_rounded(found->X_BodyFt.translation, mm);
    report["rotation_vector_deg"] = micro_rounded(log_rotation(found->X_BodyFt.rotation), deg);
    report["table_height_mm"] = micro_rounded(found->table_height / mm);
    report["height_residual_mm"] = micro_rounded(found->height_residual / mm);
    report["turn_residual_deg"] = micro_rounded(found->turn_residual / deg);
  }
  return report;
}

}  // namespace softfinger
