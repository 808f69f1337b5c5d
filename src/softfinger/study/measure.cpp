#include "softfinger/study/measure.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr std::string_view kLagged = "lagged.";
constexpr std::string_view kLoaded = "loaded.";
constexpr double kPercentile = 0.95;

struct FrameNumber {
  std::string_view name;
  double (*of)(const EvaluatedFrame& frame, bool linear_motors);
  bool loaded = false;  ///< known where the motors' hold is looked at
};

double motor_load(const EvaluatedFrame& frame, bool is_asked, double unit) {
  return frame.loaded && is_asked ? frame.motor_torque / unit : std::nan("");
}

constexpr std::array<FrameNumber, 6> kFrameNumbers{{
    {"virtual_force_N", [](const EvaluatedFrame& f, bool) { return f.virtual_force; }},
    {"virtual_force_sum_N", [](const EvaluatedFrame& f, bool) { return f.virtual_force_sum; }},
    {"twin_force_N", [](const EvaluatedFrame& f, bool) { return f.twin_force; }},
    {"twin_force_sum_N", [](const EvaluatedFrame& f, bool) { return f.twin_force_sum; }},
    {"motor_torque_N_mm",
     [](const EvaluatedFrame& f, bool linear) { return motor_load(f, !linear, mm); }, true},
    {"motor_force_N",
     [](const EvaluatedFrame& f, bool linear) { return motor_load(f, linear, 1.0); }, true},
}};

struct RunNumber {
  std::string_view name;
  double (*of)(const Evaluation& evaluation);
};

double number(std::uint64_t count) { return static_cast<double>(count); }

/// Of the first finger, as a part of the virtual side's.
double area_spread_error(const Evaluation& evaluation) {
  const AreaSpreadRates rates = area_spread_rates(evaluation, 0);
  return std::abs(rates.twin - rates.virtual_side) / rates.virtual_side;
}

constexpr std::array<RunNumber, 15> kRunNumbers{{
    {"area_spread_rate_error", area_spread_error},
    {"frames_free",
     [](const Evaluation& e) { return static_cast<double>(e.commanded.frames(FrameKind::kFree)); }},
    {"frames_missed",
     [](const Evaluation& e) {
       return static_cast<double>(e.commanded.frames(FrameKind::kMissed));
     }},
    {"frames_false",
     [](const Evaluation& e) {
       return static_cast<double>(e.commanded.frames(FrameKind::kFalse));
     }},
    {"frames_not_held",
     [](const Evaluation& e) { return e.has_loaded ? number(e.not_held) : std::nan(""); }},
    {"frames_unconverged", [](const Evaluation& e) { return number(e.unconverged); }},
    {"steps", [](const Evaluation& e) { return static_cast<double>(e.run.steps); }},
    {"unconverged_steps", [](const Evaluation& e) { return number(e.run.all.unconverged_steps); }},
    {"commands_sent", [](const Evaluation& e) { return number(e.run.all.commands_sent); }},
    {"device_ticks", [](const Evaluation& e) { return number(e.run.all.ticks); }},
    {"force_limited_ticks",
     [](const Evaluation& e) { return number(e.run.all.force_limited_ticks); }},
    {"rate_limited_ticks",
     [](const Evaluation& e) { return number(e.run.all.rate_limited_ticks); }},
    {"max_contact_area_mm2", [](const Evaluation& e) { return e.run.all.max_contact_area / mm2; }},
    {"max_normal_force_N", [](const Evaluation& e) { return e.run.all.max_normal_force; }},
    {"max_normal_force_sum_N", [](const Evaluation& e) { return e.run.all.max_normal_force_sum; }},
}};

/// Of a name without what stands before its dot; null: not one of a frame's comparison.
const MeasureName* comparison_measure(std::string_view name) {
  const auto found = std::ranges::find(measure_names(), name, &MeasureName::name);
  return found == measure_names().end() ? nullptr : &*found;
}

std::string_view without(std::string_view prefix, std::string_view name) {
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

/// Which of a frame's comparisons; null: not made.
const RenderingMeasures* comparison(const EvaluatedFrame& frame, std::string_view name) {
  if (name.starts_with(kLagged)) return frame.lagged ? &*frame.lagged : nullptr;
  if (name.starts_with(kLoaded)) return frame.loaded ? &*frame.loaded : nullptr;
  return &frame.commanded;
}

}  // namespace

double over(std::vector<double> values, Over how, bool more_is_better) {
  if (values.empty()) return std::nan("");
  if (how == Over::kMean) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  std::ranges::sort(values);
  if (more_is_better) std::ranges::reverse(values);
  if (how == Over::kWorst) return values.back();
  const double place = kPercentile * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

std::vector<std::string> measure_words() {
  std::vector<std::string> words;
  for (const std::string_view prefix : {std::string_view(), kLagged, kLoaded}) {
    for (const MeasureName& name : measure_names()) {
      words.push_back(fmt::format("{}{}", prefix, name.name));
    }
  }
  for (const FrameNumber& row : kFrameNumbers) words.emplace_back(row.name);
  for (const RunNumber& row : kRunNumbers) words.emplace_back(row.name);
  return words;
}

JudgedSides sides_for(const std::vector<std::string>& measures) {
  using Depth = SkinComparison::Depth;
  JudgedSides sides{.lagged = false, .loaded = false, .depth = Depth::kContact};
  for (const std::string_view name : measures) {
    sides.lagged = sides.lagged || name.starts_with(kLagged);
    sides.loaded = sides.loaded || name.starts_with(kLoaded) || name == "frames_not_held";
    const auto row = std::ranges::find(kFrameNumbers, name, &FrameNumber::name);
    sides.loaded = sides.loaded || (row != kFrameNumbers.end() && row->loaded);
    const std::string_view bare = without(kLoaded, without(kLagged, name));
    if (bare == "pressure_error") sides.depth = std::max(sides.depth, Depth::kSkin);
    if (bare == "strain_energy_density_error" || bare == "stress_error") {
      sides.depth = Depth::kTissue;
    }
  }
  return sides;
}

std::vector<double> measured(const Evaluation& evaluation, std::string_view measure) {
  std::vector<double> values;
  const auto add = [&values](double value) {
    if (!std::isnan(value)) values.push_back(value);
  };
  const std::string_view bare = without(kLoaded, without(kLagged, measure));
  if (const MeasureName* name = comparison_measure(bare)) {
    for (const EvaluatedFrame& frame : evaluation.frames) {
      const RenderingMeasures* side = comparison(frame, measure);
      if (side != nullptr) add(side->*name->member / name->unit);
    }
    return values;
  }
  const auto of_frame = std::ranges::find(kFrameNumbers, measure, &FrameNumber::name);
  if (of_frame != kFrameNumbers.end()) {
    for (const EvaluatedFrame& frame : evaluation.frames) {
      add(of_frame->of(frame, evaluation.linear_motors[frame.finger]));
    }
    return values;
  }
  const auto of_run = std::ranges::find(kRunNumbers, measure, &RunNumber::name);
  if (of_run != kRunNumbers.end()) add(of_run->of(evaluation));
  return values;
}

}  // namespace softfinger
