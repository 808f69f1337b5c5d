#include "softfinger/session/report/conditioning_report.hpp"

#include <fmt/core.h>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/recording/recorded_poses.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

/// `unit`: of the flag, in SI.
void check_range(const char* flag, double value, double unit, double least, double most) {
  if (value >= least * unit && value <= most * unit) return;
  throw InputError(fmt::format("{} {:g}: must be {:g} to {:g}", flag, value / unit, least, most));
}

Json json_of(const PoseError& error) {
  return {{"distance_mm", error.distance / mm}, {"turn_deg", error.turn / deg}};
}

Json json_of(const ConditioningEffect::Part& part) {
  if (!(part.time > 0.0)) return nullptr;
  return {{"time_s", part.time}, {"before", json_of(part.before)}, {"after", json_of(part.after)}};
}

}  // namespace

TrackingQuality ConditioningQuestion::usual_quality() {
  return {.rate = 120.0, .age = 15.0 * ms, .noise = 0.1 * mm, .turn_noise = 0.2 * deg};
}

ConditioningEffect conditioning_effect(const ConditioningQuestion& question) {
  const TrackingQuality& quality = question.quality;
  check_range("--rate-Hz", quality.rate, 1.0, 1.0, 1000.0);
  check_range("--age-ms", quality.age, ms, 0.0, 200.0);
  check_range("--noise-mm", quality.noise, mm, 0.0, 10.0);
  check_range("--noise-deg", quality.turn_noise, deg, 0.0, 30.0);
  PoseConditioning conditioning;
  if (question.filter) conditioning.filter.emplace();
  if (question.predict) {
    check_range("--predict-ms", *question.predict, ms, 0.0, PoseConditioning::kMostLead / ms);
    conditioning.lead = *question.predict;
  }
  if (!conditioning.changes_poses()) {
    throw InputError("--filter, --predict-ms: give one of them, or both");
  }
  CsvTracker poses = read_poses(question.motion, question.finger);
  const auto motion = [&poses](double time) { return poses.sample(time).X_WFt; };
  return conditioning_effect(motion, *poses.end_time(), quality, conditioning);
}

Json conditioning_report(const ConditioningEffect& effect) {
  return {{"resting", json_of(effect.resting)}, {"moving", json_of(effect.moving)}};
}

}  // namespace softfinger
