#include "softfinger/identification/finger_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/weighted_press_fit.hpp"

namespace softfinger {
namespace {

using Eigen::Index;
using Parameters = std::vector<FitParameter>;

constexpr double kDeviationFloor = 0.05;    // of the greatest force; below, it is the measure
constexpr double kGreatestDeviation = 0.2;  // root mean square; beyond, another finger was measured
constexpr double kFurthestForce = 1.1;      // of an area, times the greatest of the curve
constexpr double kActs = 0.02;              // change of a force that shows that a limit acts
constexpr double kWidestInterval = 0.5;     // half width, of what is estimated
constexpr std::array kAll{FitParameter::kYoungsModulus, FitParameter::kMin, FitParameter::kMax};

bool has(const Parameters& parameters, FitParameter p) {
  return std::find(parameters.begin(), parameters.end(), p) != parameters.end();
}

double& limit_of(FingerConstants& constants, FitParameter limit) {
  return limit == FitParameter::kMin ? constants.min : constants.max;
}

/// Half width of the interval over what it must be small against; infinite where it has no end.
/// The bound that the limits' width sets is an end, the one where a limit never acts is none.
double relative_width(const PressEstimate& a, std::size_t i) {
  const ConfidenceInterval& interval = a.intervals[i];
  const bool endless = (interval.low_is_open && a.parameters[i] != FitParameter::kMax) ||
                       (interval.high_is_open && a.parameters[i] != FitParameter::kMin);
  if (endless) return std::numeric_limits<double>::infinity();
  const double half = 0.5 * (interval.high - interval.low);
  switch (a.parameters[i]) {
    case FitParameter::kMin:
      return half / (1.0 - a.constants.min);
    case FitParameter::kMax:
      return half / (a.constants.max - 1.0);
    case FitParameter::kYoungsModulus:
      break;
  }
  return half;
}

/// What to give up where the data do not tell everything: the limit they tell least. Young's
/// modulus comes last: without it there is no fit.
std::optional<std::size_t> undetermined(const PressEstimate& a) {
  std::optional<std::size_t> least_known;
  double widest_limit = -1.0;
  bool any = false;
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    const double width = relative_width(a, i);
    any = any || !(width <= kWidestInterval);
    if (!least_known) least_known = i;
    if (a.parameters[i] == FitParameter::kYoungsModulus || width <= widest_limit) continue;
    least_known = i;
    widest_limit = width;
  }
  return any ? least_known : std::nullopt;
}

std::string interval_reason(const PressEstimate& a, std::size_t i) {
  const ConfidenceInterval& interval = a.intervals[i];
  if (a.parameters[i] == FitParameter::kYoungsModulus) {
    const double x = a.x[static_cast<Index>(i)];
    return fmt::format(
        "its 95 % interval would be {:.2g} to {:.2g} times the estimate; measure "
        "more points or with less noise",
        std::exp(interval.low - x), std::exp(interval.high - x));
  }
  return fmt::format(
      "its 95 % interval would be {} to {}; press deeper, measure more points or "
      "give --area",
      interval.low_is_open && a.parameters[i] == FitParameter::kMin
          ? "none"
          : fmt::format("{:.3g}", interval.low),
      interval.high_is_open && a.parameters[i] == FitParameter::kMax
          ? "none"
          : fmt::format("{:.3g}", interval.high));
}

class Fit {
 public:
  Fit(const FitInput& input, const PressSimulation& simulate)
      : input_(input), press_(input, simulate) {
    const MeasuredColumns& curve = input.curve;
    for (std::size_t i = 0; i < curve.lines.size(); ++i) {
      const bool preloaded =
          curve.first[i] == 0.0 && curve.second[i] > kDeviationFloor * press_.greatest_force();
      if (!preloaded) continue;
      curve.fail(i, fmt::format("force_N: {:.4g} at depth 0, expected about 0: depth counts from "
                                "first touch",
                                curve.second[i]));
    }
    for (std::size_t i = 0; input.areas && i < input.areas->lines.size(); ++i) {
      if (input.areas->first[i] <= kFurthestForce * press_.greatest_force()) continue;
      input.areas->fail(i, fmt::format("force_N: {:.4g} is beyond the {:.4g} of the indentation "
                                       "curve, which must reach as far",
                                       input.areas->first[i], press_.greatest_force()));
    }
  }

  FingerFit run() {
    const PressEstimate rough = press_.rough_estimate({FitParameter::kYoungsModulus}, input_.start);
    Parameters parameters = wanted(rough.constants);
    const bool modulus_is_free = has(parameters, FitParameter::kYoungsModulus);
    const PressEstimate best =
        press_.rough_estimate(parameters, modulus_is_free ? rough.constants : input_.start);
    (void)deviation_within_reach(best.constants);
    PressEstimate estimate = press_.estimate(parameters, best.constants);
    for (auto worst = undetermined(estimate); worst; worst = undetermined(estimate)) {
      const FitParameter p = estimate.parameters[*worst];
      refuse_or_keep(p, interval_reason(estimate, *worst));
      std::erase(parameters, p);
      FingerConstants start = estimate.constants;
      FingerConstants file = input_.start;
      limit_of(start, p) = limit_of(file, p);
      estimate = press_.estimate(parameters, start);
    }
    return result(estimate);
  }

 private:
  [[nodiscard]] bool asked_for(FitParameter p) const { return has(input_.parameters, p); }

  void refuse_or_keep(FitParameter p, const std::string& why) {
    if (p == FitParameter::kYoungsModulus || asked_for(p)) {
      throw InputError(fmt::format("{}: {}: the data do not tell it: {}",
                                   input_.curve.file.string(), name_of(p), why));
    }
    kept_.push_back({p, why});
  }

  /// The parameters to estimate; those whose limit does not act are refused or kept.
  Parameters wanted(const FingerConstants& at) {
    Parameters parameters;
    for (const FitParameter p : kAll) {
      const bool is_limit = p != FitParameter::kYoungsModulus;
      if (is_limit && !input_.has_limits) {
        if (asked_for(p)) refuse_or_keep(p, "the finger file has no [strain_limits]");
      } else if (!input_.parameters.empty() && !asked_for(p)) {
        kept_.push_back({p, "not asked for"});
      } else if (is_limit && !acts(p, at)) {
        refuse_or_keep(p, fmt::format("the limit changes no force by {:.0f} % up to {:.3g} mm; "
                                      "press deeper, to where the force rises steeply",
                                      100.0 * kActs, input_.curve.first.back() / mm));
      } else {
        parameters.push_back(p);
      }
    }
    return parameters;
  }

  bool acts(FitParameter limit, const FingerConstants& at) {
    FingerConstants without = at;
    limit_of(without, limit) =
        limit == FitParameter::kMin ? WeightedPressFit::kLeastMin : WeightedPressFit::kGreatestMax;
    const PressCurve* with_limit = press_.simulated(at);
    const PressCurve* forgotten = press_.simulated(without);
    if (with_limit == nullptr || forgotten == nullptr) return true;
    for (std::size_t k = 0; k < press_.rows().size(); ++k) {
      const double force = with_limit->force(press_.depth(k));
      if (std::abs(forgotten->force(press_.depth(k)) - force) > kActs * force) return true;
    }
    return false;
  }

  FingerFit result(const PressEstimate& a) {
    FingerFit fit;
    fit.constants = a.constants;
    fit.kept = kept_;
    fit.noise = a.noise;
    fit.force_noise = a.force_noise;
    if (a.noise == ForceNoise::kAbsolute) fit.force_noise *= press_.greatest_force();
    fit.area_noise = input_.areas ? a.area_noise : 0.0;
    fit.degrees_of_freedom = a.degrees_of_freedom;
    for (std::size_t i = 0; i < a.parameters.size(); ++i) {
      const bool is_modulus = a.parameters[i] == FitParameter::kYoungsModulus;
      const auto value = [&](double x) { return is_modulus ? std::exp(x) : x; };
      fit.estimates.push_back({a.parameters[i], value(a.x[static_cast<Index>(i)]),
                               value(a.intervals[i].low), value(a.intervals[i].high)});
    }
    fit.force_deviation = deviation_within_reach(a.constants);
    fit.simulations = press_.simulations();
    return fit;
  }

  /// Root mean square of the relative deviations; refuses the curve where it is too large.
  double deviation_within_reach(const FingerConstants& constants) {
    const PressCurve* simulated = press_.simulated(constants);
    double squares = 0.0, greatest = 0.0;
    std::size_t worst_row = 0;
    for (std::size_t k = 0; k < press_.rows().size(); ++k) {
      const double deviation = (simulated->force(press_.depth(k)) - press_.force(k)) /
                               std::max(press_.force(k), kDeviationFloor * press_.greatest_force());
      squares += deviation * deviation;
      if (std::abs(deviation) <= std::abs(greatest)) continue;
      greatest = deviation;
      worst_row = press_.rows()[k];
    }
    const double deviation = std::sqrt(squares / static_cast<double>(press_.rows().size()));
    if (deviation <= kGreatestDeviation) return deviation;
    input_.curve.fail(worst_row,
                      fmt::format("no constants of this finger reach the curve: the best are off "
                                  "by {:.0f} % (root mean square, expected at most {:.0f} %), by "
                                  "{:+.0f} % in this row",
                                  100.0 * deviation, 100.0 * kGreatestDeviation, 100.0 * greatest));
  }

  const FitInput& input_;
  WeightedPressFit press_;
  std::vector<FingerFit::Kept> kept_;
};

}  // namespace

std::string name_of(FitParameter parameter) {
  switch (parameter) {
    case FitParameter::kYoungsModulus:
      return "youngs_modulus_kPa";
    case FitParameter::kMin:
      return "min";
    case FitParameter::kMax:
      return "max";
  }
  return {};
}

FingerFit fit_finger(const FitInput& input, const PressSimulation& simulate) {
  return Fit(input, simulate).run();
}

double pulp_depth(const FingerModel& model) {
  double skin = std::numeric_limits<double>::infinity();
  double rigid = skin;
  for (const int node : model.sample_nodes) {
    skin = std::min(skin, model.mesh.nodes[static_cast<std::size_t>(node)].z());
  }
  for (std::size_t n = 0; n < model.mesh.nodes.size(); ++n) {
    if (model.node_is_rigid[n]) {
      rigid = std::min(rigid, model.mesh.nodes[n].z());
    }
  }
  return rigid - skin;
}

}  // namespace softfinger
