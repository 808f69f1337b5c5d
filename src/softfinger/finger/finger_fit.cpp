#include "softfinger/finger/finger_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/numerics/least_squares.hpp"

namespace softfinger {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Parameters = std::vector<FitParameter>;

constexpr double kGreatestFactor = 1e3;  // on Young's modulus, either way
constexpr double kLeastMin = 0.05, kGreatestMin = 0.95;
constexpr double kLeastMax = 1.05, kGreatestMax = 3.0;
/// Forces below this share of the greatest are weighted as if they were this large: what is left of
/// a relative error near first touch is one of the zero point.
constexpr double kWeightFloor = 0.01;
constexpr double kDeviationFloor = 0.05;    // the same, where deviations are told
constexpr double kGreatestDeviation = 0.2;  // root mean square; beyond, another finger was measured
constexpr double kActs = 0.02;              // change of a force that shows that a limit acts
constexpr double kWidestInterval = 0.5;     // half width, of what is estimated
constexpr double kFurthestForce = 1.1;      // of an area, times the greatest of the curve
constexpr double kFirstNoise = 0.05;
constexpr double kLeastNoise = 1e-7;
constexpr int kWeightPasses = 8;

/// Remembers what it has computed: passes with other weights ask for the same constants again.
class Simulations {
 public:
  explicit Simulations(const PressSimulation& simulate) : simulate_(simulate) {}
  const PressCurve* at(const FingerConstants& constants) {
    const std::array<double, 3> key{constants.youngs_modulus_factor, constants.min, constants.max};
    const auto [entry, is_new] = known_.try_emplace(key);
    if (is_new) entry->second = simulate_(constants);
    return entry->second ? &*entry->second : nullptr;
  }
  [[nodiscard]] int count() const { return static_cast<int>(known_.size()); }

 private:
  const PressSimulation& simulate_;
  std::map<std::array<double, 3>, std::optional<PressCurve>> known_;
};

/// One minimum: which parameters, where, and how well it agrees.
struct Attempt {
  Parameters parameters;
  FingerConstants constants;
  VectorXd x, half_width;  ///< Young's modulus as the logarithm of its factor
  std::vector<bool> at_bound;
  ForceNoise noise = ForceNoise::kRelative;
  double force_noise = kFirstNoise, area_noise = kFirstNoise;
  double log_likelihood = 0.0;
  int degrees_of_freedom = 0;
  bool converged = false;
};

class Fit {
 public:
  Fit(const FitInput& input, const PressSimulation& simulate)
      : input_(input), simulations_(simulate) {
    const MeasuredColumns& curve = input.curve;
    for (std::size_t i = 0; i < curve.lines.size(); ++i) {
      greatest_force_ = std::max(greatest_force_, curve.second[i]);
    }
    for (std::size_t i = 0; i < curve.lines.size(); ++i) {
      if (curve.first[i] > 0.0) {
        rows_.push_back(i);
      } else if (curve.second[i] > kDeviationFloor * greatest_force_) {
        curve.fail(i, fmt::format("force_N: {:.4g} at depth 0, expected about 0: depth counts from "
                                  "first touch",
                                  curve.second[i]));
      }
    }
    for (std::size_t i = 0; i < area_rows(); ++i) {
      if (input.areas->first[i] <= kFurthestForce * greatest_force_) continue;
      input.areas->fail(i, fmt::format("force_N: {:.4g} is beyond the {:.4g} of the indentation "
                                       "curve, which must reach as far",
                                       input.areas->first[i], greatest_force_));
    }
  }

  FingerFit run() {
    Attempt attempt = likelier({FitParameter::kYoungsModulus}, input_.start);
    Parameters parameters = wanted(attempt.constants);
    const bool modulus_is_free = std::find(parameters.begin(), parameters.end(),
                                           FitParameter::kYoungsModulus) != parameters.end();
    attempt = likelier(parameters, modulus_is_free ? attempt.constants : input_.start);
    for (auto worst = undetermined(attempt); worst; worst = undetermined(attempt)) {
      refuse_or_keep(*worst, interval_reason(attempt, *worst));
      std::erase(parameters, *worst);
      FingerConstants start = attempt.constants;
      (*worst == FitParameter::kMin ? start.min : start.max) =
          *worst == FitParameter::kMin ? input_.start.min : input_.start.max;
      attempt = likelier(parameters, start);
    }
    return result(attempt);
  }

 private:
  [[nodiscard]] const MeasuredColumns& curve() const { return input_.curve; }
  [[nodiscard]] double measured(std::size_t k) const { return curve().second[rows_[k]]; }
  [[nodiscard]] double depth(std::size_t k) const { return curve().first[rows_[k]]; }
  [[nodiscard]] std::size_t area_rows() const {
    return input_.areas ? input_.areas->lines.size() : 0;
  }
  [[nodiscard]] bool asked_for(FitParameter parameter) const {
    return std::find(input_.parameters.begin(), input_.parameters.end(), parameter) !=
           input_.parameters.end();
  }

  [[noreturn]] void refuse(FitParameter parameter, const std::string& why) const {
    throw InputError(fmt::format("{}: {}: the data do not tell it: {}", curve().file.string(),
                                 name_of(parameter), why));
  }

  void refuse_or_keep(FitParameter parameter, const std::string& why) {
    if (parameter == FitParameter::kYoungsModulus || asked_for(parameter)) refuse(parameter, why);
    kept_.push_back({parameter, why});
  }

  /// The parameters to estimate; those whose limit does not act are refused or kept.
  Parameters wanted(const FingerConstants& at) {
    Parameters parameters;
    for (const FitParameter p :
         {FitParameter::kYoungsModulus, FitParameter::kMin, FitParameter::kMax}) {
      const bool is_limit = p != FitParameter::kYoungsModulus;
      if (!input_.parameters.empty() && !asked_for(p)) {
        if (!is_limit || input_.has_limits) kept_.push_back({p, "not asked for"});
      } else if (is_limit && !input_.has_limits) {
        if (asked_for(p)) refuse(p, "the finger file has no [strain_limits]; give it some");
      } else if (is_limit && !acts(p, at)) {
        refuse_or_keep(p, fmt::format("the limit changes no force by {:.0f} % up to {:.3g} mm; "
                                      "press deeper, to where the force rises steeply",
                                      100.0 * kActs, depth(rows_.size() - 1) / mm));
      } else {
        parameters.push_back(p);
      }
    }
    return parameters;
  }

  bool acts(FitParameter limit, const FingerConstants& at) {
    FingerConstants without = at;
    (limit == FitParameter::kMin ? without.min : without.max) =
        limit == FitParameter::kMin ? kLeastMin : kGreatestMax;
    const PressCurve* with_limit = simulations_.at(at);
    const PressCurve* forgotten = simulations_.at(without);
    if (with_limit == nullptr || forgotten == nullptr) return true;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const double force = with_limit->force(depth(k));
      if (std::abs(forgotten->force(depth(k)) - force) > kActs * force) return true;
    }
    return false;
  }

  /// The attempt with the noise asked for, or the likelier of the two.
  Attempt likelier(const Parameters& parameters, const FingerConstants& start) {
    if (input_.noise) return attempt(parameters, start, *input_.noise);
    Attempt relative = attempt(parameters, start, ForceNoise::kRelative);
    Attempt absolute = attempt(parameters, relative.constants, ForceNoise::kAbsolute);
    return absolute.log_likelihood > relative.log_likelihood ? absolute : relative;
  }

  FingerConstants constants_at(const Attempt& attempt, const VectorXd& x) const {
    FingerConstants constants = attempt.constants;
    for (std::size_t i = 0; i < attempt.parameters.size(); ++i) {
      const double value = x[static_cast<Index>(i)];
      switch (attempt.parameters[i]) {
        case FitParameter::kYoungsModulus:
          constants.youngs_modulus_factor = std::exp(value);
          break;
        case FitParameter::kMin:
          constants.min = value;
          break;
        case FitParameter::kMax:
          constants.max = value;
          break;
      }
    }
    return constants;
  }

  /// Standard deviation of force k by the noise model, up to a common factor.
  [[nodiscard]] double spread(ForceNoise noise, double force) const {
    return noise == ForceNoise::kAbsolute ? greatest_force_
                                          : std::max(force, kWeightFloor * greatest_force_);
  }

  VectorXd residuals(const FingerConstants& constants, const std::vector<double>& spreads,
                     double force_noise, double area_noise) {
    const PressCurve* simulated = simulations_.at(constants);
    if (simulated == nullptr) return {};
    VectorXd r(static_cast<Index>(rows_.size() + area_rows()));
    Index at = 0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      r[at++] = (simulated->force(depth(k)) - measured(k)) / (spreads[k] * force_noise);
    }
    for (std::size_t k = 0; k < area_rows(); ++k) {
      r[at++] =
          std::log(simulated->area(input_.areas->first[k]) / input_.areas->second[k]) / area_noise;
    }
    return r;
  }

  /// Least squares whose weights follow the simulated forces and the residuals, pass by pass.
  Attempt attempt(const Parameters& parameters, const FingerConstants& start, ForceNoise noise) {
    Attempt a;
    a.parameters = parameters;
    a.constants = start;
    a.noise = noise;
    const auto unknowns = static_cast<Index>(parameters.size());
    LeastSquaresProblem problem;
    problem.lower.resize(unknowns);
    problem.upper.resize(unknowns);
    problem.difference_step.resize(unknowns);
    a.x.resize(unknowns);
    for (Index i = 0; i < unknowns; ++i) set_unknown(parameters, start, i, problem, a.x);
    std::vector<double> spreads;
    for (std::size_t k = 0; k < rows_.size(); ++k) spreads.push_back(spread(noise, measured(k)));

    const double rows = static_cast<double>(rows_.size() + area_rows());
    a.degrees_of_freedom = static_cast<int>(rows) - static_cast<int>(unknowns);
    const double free_share = a.degrees_of_freedom / rows;
    LeastSquaresSolution solution;
    for (int pass = 0; pass < kWeightPasses; ++pass) {
      problem.residuals = [&](const VectorXd& x) {
        return residuals(constants_at(a, x), spreads, a.force_noise, a.area_noise);
      };
      solution = minimise_squares(problem, a.x);
      if (solution.residuals.size() == 0) {
        throw OperationError(
            "finger fit: the press does not reach equilibrium with the finger's "
            "own constants");
      }
      a.x = solution.x;
      const auto forces = static_cast<Index>(rows_.size());
      const auto areas = static_cast<Index>(area_rows());
      const double force_squares = solution.residuals.head(forces).squaredNorm();
      const double area_squares = solution.residuals.tail(areas).squaredNorm();
      const double force_scale =
          std::sqrt(force_squares / (free_share * static_cast<double>(forces)));
      const double area_scale =
          areas == 0 ? 1.0 : std::sqrt(area_squares / (free_share * static_cast<double>(areas)));
      const PressCurve* simulated = simulations_.at(constants_at(a, a.x));
      double change = std::max(std::abs(force_scale - 1.0), std::abs(area_scale - 1.0));
      a.force_noise = std::max(a.force_noise * force_scale, kLeastNoise);
      a.area_noise = std::max(a.area_noise * area_scale, kLeastNoise);
      a.log_likelihood = -static_cast<double>(forces) * std::log(a.force_noise) -
                         static_cast<double>(areas) * std::log(a.area_noise);
      for (std::size_t k = 0; k < rows_.size(); ++k) {
        a.log_likelihood -= std::log(spreads[k]);
        const double next = spread(noise, simulated->force(depth(k)));
        change = std::max(change, std::abs(next / spreads[k] - 1.0));
        spreads[k] = next;
      }
      if (pass > 0 && change < 1e-2) break;
    }
    a.converged = solution.converged;
    a.constants = constants_at(a, a.x);
    set_intervals(problem, solution, a);
    return a;
  }

  void set_unknown(const Parameters& parameters, const FingerConstants& start, Index i,
                   LeastSquaresProblem& problem, VectorXd& x) const {
    const auto set = [&](double low, double high, double step, double value) {
      problem.lower[i] = low;
      problem.upper[i] = high;
      problem.difference_step[i] = step;
      x[i] = value;
    };
    const double widest = std::log(kGreatestFactor);
    switch (parameters[static_cast<std::size_t>(i)]) {
      case FitParameter::kYoungsModulus:
        set(-widest, widest, 0.005, std::log(start.youngs_modulus_factor));
        break;
      case FitParameter::kMin:
        set(kLeastMin, kGreatestMin, 0.004, start.min);
        break;
      case FitParameter::kMax:
        set(kLeastMax, kGreatestMax, 0.008, start.max);
        break;
    }
  }

  /// Half widths t s sqrt((J^T J)^-1_ii); infinite where J does not have full rank.
  static void set_intervals(const LeastSquaresProblem& problem, const LeastSquaresSolution& at,
                            Attempt& a) {
    const Index n = at.x.size();
    a.half_width = VectorXd::Constant(n, std::numeric_limits<double>::infinity());
    for (Index i = 0; i < n; ++i) {
      a.at_bound.push_back(at.x[i] <= problem.lower[i] || at.x[i] >= problem.upper[i]);
    }
    if (at.jacobian.rows() <= n || n == 0) return;
    const VectorXd norms = at.jacobian.colwise().norm().transpose();
    if (!(norms.minCoeff() > 0.0)) return;
    const Eigen::MatrixXd scaled = at.jacobian * norms.cwiseInverse().asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled.transpose() * scaled);
    if (eigen.eigenvalues()[0] < 1e-10) return;
    const double t = student_t_quantile(0.975, a.degrees_of_freedom);
    const double s = std::sqrt(at.sum_of_squares() / a.degrees_of_freedom);
    for (Index i = 0; i < n; ++i) {
      const double variance =
          (eigen.eigenvectors().row(i).array().square().transpose() / eigen.eigenvalues().array())
              .sum();
      // The noise of data that agree exactly is that of the simulation.
      a.half_width[i] = t * std::max(s, 1e-9) * std::sqrt(variance) / norms[i];
    }
  }

  /// Half width of the interval over what it must be small against.
  [[nodiscard]] static double relative_width(const Attempt& a, std::size_t i) {
    const double half = a.half_width[static_cast<Index>(i)];
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
  static std::optional<FitParameter> undetermined(const Attempt& a) {
    std::optional<FitParameter> least_known;
    double widest_limit = -1.0;
    bool any = false;
    for (std::size_t i = 0; i < a.parameters.size(); ++i) {
      const double width =
          a.at_bound[i] ? std::numeric_limits<double>::infinity() : relative_width(a, i);
      any = any || !(width <= kWidestInterval);
      if (!least_known) least_known = a.parameters[i];
      if (a.parameters[i] == FitParameter::kYoungsModulus || width <= widest_limit) continue;
      least_known = a.parameters[i];
      widest_limit = width;
    }
    return any ? least_known : std::nullopt;
  }

  std::string interval_reason(const Attempt& a, FitParameter p) const {
    const auto i = static_cast<std::size_t>(std::find(a.parameters.begin(), a.parameters.end(), p) -
                                            a.parameters.begin());
    const auto index = static_cast<Index>(i);
    const bool is_modulus = p == FitParameter::kYoungsModulus;
    const std::string what = a.at_bound[i]
                                 ? fmt::format("it runs to its bound, {:.3g}",
                                               is_modulus ? std::exp(a.x[index]) : a.x[index])
                                 : fmt::format("its 95 % interval would be {:.3g} +- {:.2g}{}",
                                               is_modulus ? 1.0 : a.x[index], a.half_width[index],
                                               is_modulus ? " of itself" : "");
    return what + (is_modulus ? "; measure more points or with less noise"
                              : "; press deeper, measure more points or give --area");
  }

  FingerFit result(const Attempt& a) {
    FingerFit fit;
    fit.constants = a.constants;
    fit.kept = kept_;
    fit.noise = a.noise;
    fit.force_noise =
        a.noise == ForceNoise::kAbsolute ? a.force_noise * greatest_force_ : a.force_noise;
    fit.area_noise = input_.areas ? a.area_noise : 0.0;
    fit.degrees_of_freedom = a.degrees_of_freedom;
    for (std::size_t i = 0; i < a.parameters.size(); ++i) {
      const auto index = static_cast<Index>(i);
      const double low = a.x[index] - a.half_width[index];
      const double high = a.x[index] + a.half_width[index];
      const bool is_modulus = a.parameters[i] == FitParameter::kYoungsModulus;
      const auto value = [&](double x) { return is_modulus ? std::exp(x) : x; };
      fit.estimates.push_back({a.parameters[i], value(a.x[index]), value(low), value(high)});
    }
    check_reach(a.constants, fit);
    fit.simulations = simulations_.count();
    return fit;
  }

  void check_reach(const FingerConstants& constants, FingerFit& fit) {
    const PressCurve* simulated = simulations_.at(constants);
    double squares = 0.0, greatest = 0.0;
    std::size_t at = 0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const double deviation = (simulated->force(depth(k)) - measured(k)) /
                               std::max(measured(k), kDeviationFloor * greatest_force_);
      squares += deviation * deviation;
      if (std::abs(deviation) <= std::abs(greatest)) continue;
      greatest = deviation;
      at = k;
    }
    fit.force_deviation = std::sqrt(squares / static_cast<double>(rows_.size()));
    if (fit.force_deviation <= kGreatestDeviation) return;
    curve().fail(
        rows_[at],
        fmt::format("no constants of this finger reach the curve: the best are off by "
                    "{:.0f} % (root mean square, at most {:.0f} % expected), by {:+.0f} % "
                    "in this row",
                    100.0 * fit.force_deviation, 100.0 * kGreatestDeviation, 100.0 * greatest));
  }

  const FitInput& input_;
  Simulations simulations_;
  std::vector<std::size_t> rows_;  ///< of the curve, depth above 0
  double greatest_force_ = 0.0;
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
    if (model.node_is_rigid[n]) rigid = std::min(rigid, model.mesh.nodes[n].z());
  }
  return rigid - skin;
}

}  // namespace softfinger
