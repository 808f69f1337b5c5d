#include "softfinger/session/report/evaluation_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/session/report/run_report.hpp"
#include "softfinger/twin/perception.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value, double unit) {
  return std::isnan(value) ? Json(nullptr) : Json(value / unit);
}

Json measures_json(const RenderingMeasures& measures) {
  Json result = Json::object();
  for (const MeasureName& name : measure_names()) {
    result[std::string(name.name)] = number(measures.*name.member, name.unit);
  }
  return result;
}

Json vector_json(const Vector3& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json frame_json(const EvaluatedFrame& frame, const Evaluation& evaluation) {
  Json result{{"time_s", frame.time}, {"finger", evaluation.fingers[frame.finger]}};
  result.update(measures_json(frame.commanded));
  result["virtual_force_N"] = frame.virtual_force;
  result["virtual_force_sum_N"] = frame.virtual_force_sum;
  result["twin_force_N"] = frame.twin_force;
  result["twin_force_sum_N"] = frame.twin_force_sum;
  result["virtual_contact_area_mm2"] = frame.virtual_area / mm2;
  result["twin_contact_area_mm2"] = frame.twin_area / mm2;
  result["virtual_tangential_N"] = vector_json(frame.virtual_tangential_F);
  result["twin_tangential_N"] = vector_json(frame.twin_tangential_F);
  result["lagged"] = frame.lagged ? measures_json(*frame.lagged) : Json(nullptr);
  result["loaded"] = frame.loaded ? measures_json(*frame.loaded) : Json(nullptr);
  if (frame.loaded) {
    const bool linear = evaluation.linear_motors[frame.finger];
    result[linear ? "motor_force_N" : "motor_torque_N_mm"] =
        frame.motor_torque / (linear ? 1.0 : mm);
    result["motors_hold"] = !frame.motors_give_way;
  }
  return result;
}

Json area_spread_json(const Evaluation& evaluation) {
  Json result = Json::array();
  for (std::size_t finger = 0; finger < evaluation.fingers.size(); ++finger) {
    const AreaSpreadRates rates = area_spread_rates(evaluation, finger);
    result.push_back({{"finger", evaluation.fingers[finger]},
                      {"virtual_mm2_per_N", number(rates.virtual_side, mm2)},
                      {"twin_mm2_per_N", number(rates.twin, mm2)}});
  }
  return result;
}

/// Frames in which this measure is defined, and those of them in which people would notice it.
struct Noticed {
  int frames = 0, noticed = 0;
};

Noticed count_noticed(const Evaluation& evaluation, const MeasureName& name, double threshold) {
  Noticed count;
  for (const EvaluatedFrame& frame : evaluation.frames) {
    const double value = frame.commanded.*name.member;
    if (std::isnan(value)) continue;
    ++count.frames;
    if (value >= threshold) ++count.noticed;
  }
  return count;
}

Json verdict_json(const Evaluation& evaluation) {
  const RenderingMeasures mean = evaluation.commanded.mean();
  Json verdict = Json::array();
  for (const MeasureName& name : measure_names()) {
    const PerceptionThreshold* threshold = perception_threshold(name.name);
    const double value = mean.*name.member;
    if (threshold == nullptr || std::isnan(value)) continue;
    const Noticed count = count_noticed(evaluation, name, threshold->threshold);
    verdict.push_back({{"measure", name.name},
                       {"mean", value / name.unit},
                       {"threshold", threshold->threshold / name.unit},
                       {"noticeable", value >= threshold->threshold},
                       {"noticeable_frames", static_cast<double>(count.noticed) / count.frames},
                       {"what", threshold->what},
                       {"source", threshold->source}});
  }
  return verdict;
}

}  // namespace

Json evaluation_report(const Evaluation& evaluation) {
  Json result;
  result["mean"] = measures_json(evaluation.commanded.mean());
  result["lagged_mean"] =
      evaluation.has_lagged ? measures_json(evaluation.lagged.mean()) : Json(nullptr);
  result["loaded_mean"] =
      evaluation.has_loaded ? measures_json(evaluation.loaded.mean()) : Json(nullptr);
  result["frames_not_held"] = evaluation.has_loaded ? Json(evaluation.not_held) : Json(nullptr);
  result["frames_free"] = evaluation.commanded.frames(FrameKind::kFree);
  result["frames_missed"] = evaluation.commanded.frames(FrameKind::kMissed);
  result["frames_false"] = evaluation.commanded.frames(FrameKind::kFalse);
  result["frames_unconverged"] = evaluation.unconverged;
  result["area_spread_rate"] = area_spread_json(evaluation);
  result["verdict"] = verdict_json(evaluation);
  result.update(run_report(evaluation.run));
  result["frames"] = Json::array();
  for (const EvaluatedFrame& frame : evaluation.frames) {
    result["frames"].push_back(frame_json(frame, evaluation));
  }
  return result;
}

std::string evaluation_report_text(const Evaluation& evaluation) {
  const MeasureMeans& means = evaluation.commanded;
  std::string text =
      fmt::format("{} frames: {} touch, {} free, {} missed, {} false\n", evaluation.frames.size(),
                  means.frames(FrameKind::kBoth), means.frames(FrameKind::kFree),
                  means.frames(FrameKind::kMissed), means.frames(FrameKind::kFalse));
  const RenderingMeasures commanded = means.mean();
  const RenderingMeasures lagged = evaluation.lagged.mean();
  const RenderingMeasures loaded = evaluation.loaded.mean();
  const auto cell = [](double value, double unit) {
    return std::isnan(value) ? std::string("-") : fmt::format("{:.3g}", value / unit);
  };
  text += fmt::format("  {:<28} {:>9} {:>9} {:>10} {:>12}\n", "mean of", "commanded", "at servos",
                      "under load", "felt from");
  std::string sources;
  for (const MeasureName& name : measure_names()) {
    const double value = commanded.*name.member;
    const PerceptionThreshold* threshold = perception_threshold(name.name);
    text += fmt::format(
        "  {:<28} {:>9} {:>9} {:>10} {:>12}", name.name, cell(value, name.unit),
        evaluation.has_lagged ? cell(lagged.*name.member, name.unit) : std::string("-"),
        evaluation.has_loaded ? cell(loaded.*name.member, name.unit) : std::string("-"),
        threshold != nullptr ? cell(threshold->threshold, name.unit) : std::string("-"));
    if (threshold != nullptr && !std::isnan(value)) {
      const Noticed count = count_noticed(evaluation, name, threshold->threshold);
      text += fmt::format("   {}, in {:.0f} % of frames",
                          value >= threshold->threshold ? "noticeable" : "not noticeable",
                          100.0 * count.noticed / count.frames);
      sources += fmt::format("  {}: {} ({})\n", name.name, threshold->what, threshold->source);
    }
    text += "\n";
  }
  for (std::size_t finger = 0; finger < evaluation.fingers.size(); ++finger) {
    const AreaSpreadRates rates = area_spread_rates(evaluation, finger);
    if (std::isnan(rates.virtual_side) || std::isnan(rates.twin)) continue;
    text += fmt::format("  finger {}: contact grows by {:.3g} mm2/N, on the twin by {:.3g} mm2/N\n",
                        evaluation.fingers[finger], rates.virtual_side / mm2, rates.twin / mm2);
  }
  if (evaluation.not_held > 0) {
    text += fmt::format("  in {} of {} frames the motors cannot hold what is commanded\n",
                        evaluation.not_held, evaluation.frames.size());
  }
  if (evaluation.unconverged > 0) {
    text += fmt::format("  {} presses of the twin did not come to rest\n", evaluation.unconverged);
  }
  return text + "thresholds:\n" + sources;
}

}  // namespace softfinger
