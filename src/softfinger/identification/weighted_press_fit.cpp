#include "softfinger/identification/weighted_press_fit.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kGreatestFactor = 1e3;  // on Young's modulus, either way
/// Forces below this share of the greatest are weighted as if they were this large: what is left of
/// a relative error near first touch is one of the zero point.
constexpr double kWeightFloor = 0.01;
constexpr double kLeastNoise = 1e-7;
constexpr int kWeightPasses = 8;
constexpr double kSteadyWeights = 1e-2;
constexpr double kWorthATry = 10.0;  // difference of log likelihoods

VectorXd unknowns_of(const std::vector<FitParameter>& parameters, const FingerConstants& c) {
  VectorXd x(static_cast<Index>(parameters.size()));
  for (Index i = 0; i < x.size(); ++i) {
    switch (parameters[static_cast<std::size_t>(i)]) {
      case FitParameter::kYoungsModulus:
        x[i] = std::log(c.youngs_modulus_factor);
        break;
      case FitParameter::kMin:
        x[i] = c.min;
        break;
      case FitParameter::kMax:
        x[i] = c.max;
        break;
    }
  }
  return x;
}

FingerConstants constants_of(const PressEstimate& estimate, const VectorXd& x) {
  FingerConstants constants = estimate.constants;
  for (Index i = 0; i < x.size(); ++i) {
    switch (estimate.parameters[static_cast<std::size_t>(i)]) {
      case FitParameter::kYoungsModulus:
        constants.youngs_modulus_factor = std::exp(x[i]);
        break;
      case FitParameter::kMin:
        constants.min = x[i];
        break;
      case FitParameter::kMax:
        constants.max = x[i];
        break;
    }
  }
  return constants;
}

/// Standard deviation of residuals in units of what was assumed; `freedom` is its share per row.
double scale_of(const VectorXd& residuals, double freedom) {
  if (residuals.size() == 0) return 1.0;
  return std::sqrt(residuals.squaredNorm() / (freedom * static_cast<double>(residuals.size())));
}

}  // namespace

WeightedPressFit::WeightedPressFit(const FitInput& input, const PressSimulation& simulate)
    : input_(input), simulate_(simulate) {
  for (std::size_t i = 0; i < input.curve.lines.size(); ++i) {
    if (input.curve.first[i] > 0.0) rows_.push_back(i);
    greatest_force_ = std::max(greatest_force_, input.curve.second[i]);
  }
}

const PressCurve* WeightedPressFit::simulated(const FingerConstants& constants) {
  const std::array<double, 3> key{constants.youngs_modulus_factor, constants.min, constants.max};
  const auto [entry, is_new] = known_.try_emplace(key);
  if (is_new) entry->second = simulate_(constants);
  return entry->second ? &*entry->second : nullptr;
}

std::size_t WeightedPressFit::area_rows() const {
  return input_.areas ? input_.areas->lines.size() : 0;
}

double WeightedPressFit::spread(ForceNoise noise, double force) const {
  return noise == ForceNoise::kAbsolute ? greatest_force_
                                        : std::max(force, kWeightFloor * greatest_force_);
}

VectorXd WeightedPressFit::residuals(const PressEstimate& at, const VectorXd& x,
                                     const std::vector<double>& spreads) {
  const PressCurve* curve = simulated(constants_of(at, x));
  if (curve == nullptr) return {};
  VectorXd r(static_cast<Index>(rows_.size() + area_rows()));
  Index row = 0;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    r[row++] = (curve->force(depth(k)) - force(k)) / (spreads[k] * at.force_noise);
  }
  for (std::size_t k = 0; k < area_rows(); ++k) {
    const double area = curve->area(input_.areas->first[k]);
    r[row++] = std::log(area / input_.areas->second[k]) / at.area_noise;
  }
  return r;
}

LeastSquaresProblem WeightedPressFit::make_problem(
    const std::vector<FitParameter>& parameters) const {
  const auto n = static_cast<Index>(parameters.size());
  LeastSquaresProblem problem{{}, VectorXd(n), VectorXd(n), VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const auto set = [&](double low, double high, double step) {
      problem.lower[i] = low;
      problem.upper[i] = high;
      problem.difference_step[i] = step;
    };
    switch (parameters[static_cast<std::size_t>(i)]) {
      case FitParameter::kYoungsModulus:
        set(-std::log(kGreatestFactor), std::log(kGreatestFactor), 0.005);
        break;
      case FitParameter::kMin:
        set(kLeastMin, 1.0 - input_.width, 0.004);
        break;
      case FitParameter::kMax:
        set(1.0 + input_.width, kGreatestMax, 0.008);
        break;
    }
  }
  return problem;
}

PressEstimate WeightedPressFit::fit(const std::vector<FitParameter>& parameters,
                                    const FingerConstants& start, ForceNoise noise,
                                    bool with_intervals) {
  PressEstimate a;
  a.parameters = parameters;
  a.constants = start;
  a.noise = noise;
  a.x = unknowns_of(parameters, start);
  const auto forces = static_cast<Index>(rows_.size());
  const auto areas = static_cast<Index>(area_rows());
  a.degrees_of_freedom = static_cast<int>(forces + areas - a.x.size());
  const double freedom = std::max(1, a.degrees_of_freedom) / static_cast<double>(forces + areas);
  LeastSquaresProblem problem = make_problem(parameters);
  std::vector<double> spreads;
  for (std::size_t k = 0; k < rows_.size(); ++k) spreads.push_back(spread(noise, force(k)));
  problem.residuals = [&](const VectorXd& x) { return residuals(a, x, spreads); };

  LeastSquaresSolution solution;
  for (int pass = 0; pass < kWeightPasses; ++pass) {
    solution = minimise_squares(problem, a.x);
    if (solution.residuals.size() == 0) {
      throw OperationError("finger fit: the press does not reach equilibrium at the start");
    }
    a.x = solution.x;
    const double force_scale = scale_of(solution.residuals.head(forces), freedom);
    const double area_scale = scale_of(solution.residuals.tail(areas), freedom);
    const PressCurve* curve = simulated(constants_of(a, a.x));
    double change = std::max(std::abs(force_scale - 1.0), std::abs(area_scale - 1.0));
    std::vector<double> next;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      next.push_back(spread(noise, curve->force(depth(k))));
      change = std::max(change, std::abs(next[k] / spreads[k] - 1.0));
    }
    if (change < kSteadyWeights) break;
    spreads = std::move(next);
    a.force_noise = std::max(a.force_noise * force_scale, kLeastNoise);
    a.area_noise = std::max(a.area_noise * area_scale, kLeastNoise);
  }
  if (with_intervals) {
    for (Index i = 0; i < a.x.size(); ++i) {
      a.intervals.push_back(a.degrees_of_freedom > 0 ? profile_interval(problem, solution, i)
                                                     : ConfidenceInterval{0.0, 0.0, true, true});
    }
  }
  a.constants = constants_of(a, a.x);
  a.log_likelihood = log_likelihood(a, noise);
  return a;
}

double WeightedPressFit::log_likelihood(const PressEstimate& at, ForceNoise noise) {
  const PressCurve* curve = simulated(at.constants);
  double squares = 0.0, logs = 0.0;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const double expected = curve->force(depth(k));
    const double width = spread(noise, expected);
    squares += std::pow((expected - force(k)) / width, 2);
    logs += std::log(width);
  }
  const auto n = static_cast<double>(rows_.size());
  return -0.5 * n * std::log(squares / n + kLeastNoise * kLeastNoise) - logs;
}

PressEstimate WeightedPressFit::rough_estimate(const std::vector<FitParameter>& parameters,
                                               const FingerConstants& start) {
  return fit(parameters, start, ForceNoise::kRelative, false);
}

PressEstimate WeightedPressFit::estimate(const std::vector<FitParameter>& parameters,
                                         const FingerConstants& start) {
  ForceNoise noise = input_.noise.value_or(ForceNoise::kRelative);
  PressEstimate best = fit(parameters, start, noise, false);
  if (!input_.noise &&
      log_likelihood(best, ForceNoise::kAbsolute) > best.log_likelihood - kWorthATry) {
    const PressEstimate other = fit(parameters, best.constants, ForceNoise::kAbsolute, false);
    if (other.log_likelihood > best.log_likelihood) noise = ForceNoise::kAbsolute;
    if (other.log_likelihood > best.log_likelihood) best = other;
  }
  return fit(parameters, best.constants, noise, true);
}

}  // namespace softfinger
