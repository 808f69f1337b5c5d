#include "softfinger/matching/deviation_minimiser.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace softfinger {
namespace {

// Stages of attraction to home, relative to one sample's weight. Only the last one is needed where
// E has curvature in every direction; it shifts the minimum by less than a nanometre.
constexpr std::array<double, 4> kStages{1e-2, 1e-4, 1e-7, 1e-10};
constexpr double kFlat = 1e-3;            // curvature of E below which the stages are walked
constexpr double kLongestStep = 5e-3;     // m
constexpr double kStageTolerance = 1e-6;  // m; a step of the stages before the last
// The gradient that limits leave, m, where E is at most kLarge (m^2), else in proportion.
constexpr double kGradientTolerance = 5e-12;
constexpr double kLarge = 1e-6;
constexpr double kValleySlope = 1e-6;  // decrease of E, of all of it or of kSmall, that is none
constexpr double kSmall = 1e-7;        // m^2
constexpr double kSame = 2e-5;         // m; nearer minima are not told apart
constexpr double kFeasibilityMargin = 1e-13;  // m
constexpr double kRounding = 1e-17;           // m

}  // namespace

DeviationMinimiser::DeviationMinimiser(const Device& device)
    : device_(device),
      n_(device.degrees_of_freedom()),
      here_(n_),
      there_(n_),
      metric_(n_),
      gradient_(n_),
      values_(device.constraint_count()),
      raw_values_(device.constraint_count()),
      matrix_(n_, n_),
      jacobian_(device.constraint_count(), n_),
      curvature_(n_, n_),
      program_(n_, device.constraint_count()),
      projection_(n_, device.constraint_count()),
      multipliers_(Eigen::VectorXd::Zero(device.constraint_count())),
      zero_(Eigen::VectorXd::Zero(n_)) {
  for (int k = 0; k < n_; ++k) metric_[k] = device.axes()[static_cast<std::size_t>(k)].metric;
  // The projection's metric is |ds|^2 and never changes.
  static_cast<void>(projection_.factor(Eigen::MatrixXd::Identity(n_, n_)));
}

void DeviationMinimiser::expand(const Configuration& q, Expansion& expansion) const {
  expansion.value = device_.deviation_derivatives(q, *samples_, expansion.gradient,
                                                  expansion.gauss_newton, expansion.hessian);
  for (int j = 0; j < n_; ++j) {
    expansion.gradient[j] /= metric_[j];
    for (int i = 0; i < n_; ++i) {
      const double scale = 1.0 / (metric_[i] * metric_[j]);
      expansion.gauss_newton(i, j) *= scale;
      expansion.hessian(i, j) *= scale;
    }
  }
}

double DeviationMinimiser::attracted(double deviation, const Configuration& q) const {
  return deviation + attraction_ * device_.squared_distance(q, device_.home());
}

// Whether some direction has no curvature.
bool DeviationMinimiser::degenerate(const Eigen::MatrixXd& curvature) {
  matrix_ = curvature;
  for (int k = 0; k < n_; ++k) matrix_(k, k) -= kFlat;
  return !program_.factor(matrix_);
}

// Constraints at q, by s.
bool DeviationMinimiser::evaluate_constraints(const Configuration& q) {
  if (!device_.constraints(q, values_, jacobian_)) return false;
  for (int j = 0; j < n_; ++j) jacobian_.col(j) /= metric_[j];
  return true;
}

// Moves q by the least |ds| to satisfy all constraints; false if that fails. Leaves the constraints
// of the q returned in values_ and jacobian_.
bool DeviationMinimiser::restore(Configuration& q) {
  for (int round = 0; round < 8; ++round) {
    if (!evaluate_constraints(q)) {
      limited_ = true;
      return false;
    }
    if (values_.maxCoeff() <= 0.0) return true;
    limited_ = true;
    raw_values_ = values_.array() + kFeasibilityMargin;
    if (!projection_.solve(zero_, raw_values_, jacobian_)) return false;
    const double length = projection_.step().norm();
    if (!(length < 2.0 * kLongestStep)) return false;
    for (int k = 0; k < n_; ++k) q[k] += projection_.step()[k] / metric_[k];
  }
  return false;
}

// Newton direction at q, from here_ (and the constraints there), in program_.step(); with `exact`
// by the second derivatives, else by the Gauss-Newton matrix. False where the matrix is not
// positive definite.
bool DeviationMinimiser::form_direction(const Configuration& q, bool inside, double damping,
                                        bool exact) {
  gradient_ = here_.gradient;
  matrix_ = exact ? here_.hessian : here_.gauss_newton;
  for (int k = 0; k < n_; ++k) {
    gradient_[k] += 2.0 * attraction_ * metric_[k] * (q[k] - device_.home()[k]);
    matrix_(k, k) += 2.0 * attraction_ + damping;
  }
  if (inside && multipliers_.maxCoeff() > 0.0) {
    curvature_.setZero();
    device_.add_constraint_curvature(q, multipliers_, curvature_);
    for (int j = 0; j < n_; ++j) {
      for (int i = 0; i < n_; ++i) {
        const double bend = curvature_(i, j) / (metric_[i] * metric_[j]);
        matrix_(i, j) += bend;
      }
    }
  }
  if (!program_.factor(matrix_)) return false;
  if (!inside) {
    program_.solve(gradient_);
    return true;
  }
  // Aims at where restore() would end.
  raw_values_ = values_.array() + kFeasibilityMargin;
  const bool feasible = program_.solve(gradient_, raw_values_, jacobian_);
  limited_ = limited_ || !feasible || program_.multipliers().maxCoeff() > 0.0;
  return feasible;
}

// Norm of the gradient at q that the limits leave, by the optimality conditions of the program that
// gave the step.
double DeviationMinimiser::free_gradient() const {
  double squared = 0.0;
  // By rows: a product would want memory.
  for (int k = 0; k < n_; ++k) {
    const double one = matrix_.row(k).dot(program_.step());
    squared += one * one;
  }
  return std::sqrt(squared);
}

DeviationMinimiser::Stage DeviationMinimiser::descend(Configuration& q, bool inside,
                                                      int iteration_limit, int& iterations) {
  double damping = 0.0;
  const bool last = attraction_ <= kStages.back();
  multipliers_.setZero();
  while (iterations < iteration_limit) {
    double scale = 1e-3;
    for (int k = 0; k < n_; ++k) scale = std::max(scale, here_.gauss_newton(k, k));
    bool formed = form_direction(q, inside, damping, true);
    if (!formed) formed = form_direction(q, inside, damping, false);
    if (!formed) {  // the multipliers' curvature is in the way, or damping is missing
      multipliers_.setZero();
      formed = form_direction(q, inside, std::max(damping, 1e-6 * scale), false);
    }
    if (!formed) return Stage::kStalled;
    if (last && free_gradient() <= kGradientTolerance * std::max(1.0, here_.value / kLarge)) {
      return Stage::kConverged;
    }
    ++iterations;
    const Eigen::VectorXd& step = program_.step();
    const double length = step.norm();
    const double value = attracted(here_.value, q);
    const double slope = gradient_.dot(step);
    const double shrink = length > kLongestStep ? kLongestStep / length : 1.0;
    if (inside) multipliers_ = program_.multipliers();

    // Distances are exact to kRounding; and iterates are on their limits to the margin only, which
    // E feels by the multipliers.
    const double rounding = 1e-13 * value + kRounding * std::sqrt(scale * value) +
                            (inside ? 4.0 * kFeasibilityMargin * multipliers_.sum() : 0.0);
    bool accepted = false;
    double fraction = shrink;
    for (int halving = 0; halving < 12; ++halving, fraction *= 0.5) {
      Configuration trial = q;
      for (int k = 0; k < n_; ++k) trial[k] += fraction * step[k] / metric_[k];
      if (inside) {
        if (!restore(trial)) continue;
        if (fraction * length > 5e-4 && !device_.reachable(trial)) {
          limited_ = true;
          continue;
        }
      }
      double trial_value = 0.0;
      if (halving == 0) {
        expand(trial, there_);
        trial_value = attracted(there_.value, trial);
      } else {
        trial_value = attracted(device_.deviation(trial, *samples_), trial);
      }
      if (trial_value <= value + 1e-4 * fraction * std::min(slope, 0.0) + rounding) {
        q = trial;
        if (halving > 0) expand(q, there_);
        accepted = true;
        break;
      }
    }
    if (!accepted) {
      if (!last && length < kStageTolerance) return Stage::kConverged;
      if (inside && !evaluate_constraints(q)) return Stage::kStalled;
      if (-slope <= rounding || damping > 1e3 * scale) return Stage::kStalled;
      damping = std::max(10.0 * damping, 1e-3 * scale);
      continue;
    }
    std::swap(here_, there_);
    // What is left is the way along a valley that bends, for the stages before.
    if (may_be_flat_ && -slope < kValleySlope * std::max(value, kSmall) &&
        degenerate(here_.hessian)) {
      return Stage::kValley;
    }
    damping = fraction == shrink ? (damping < 1e-6 * scale ? 0.0 : 0.1 * damping) : damping;
    if (!last && length < kStageTolerance) return Stage::kConverged;
    if (known_ != nullptr && device_.squared_distance(q, *known_) < kSame * kSame) {
      return Stage::kKnown;
    }
  }
  return Stage::kIterationLimit;
}

DeviationMinimiser::Outcome DeviationMinimiser::minimise(const SurfaceSamples& samples,
                                                         const Configuration& start, bool inside,
                                                         int iteration_limit,
                                                         const Configuration* known) {
  samples_ = &samples;
  known_ = known;
  limited_ = false;
  Outcome outcome;
  outcome.q = start;
  if (inside && !(restore(outcome.q) && device_.reachable(outcome.q))) {
    outcome.limited = true;
    return outcome;
  }
  outcome.valid = true;
  expand(outcome.q, here_);
  const bool flat = samples.contact_count == 0 || degenerate(here_.gauss_newton);
  Stage stage = Stage::kConverged;
  const auto walk = [&](std::size_t first) {
    for (std::size_t k = first; k < kStages.size() && stage != Stage::kKnown; ++k) {
      attraction_ = kStages[k];
      stage = descend(outcome.q, inside, iteration_limit, outcome.iterations);
    }
  };
  may_be_flat_ = !flat;
  walk(flat ? 0 : kStages.size() - 1);
  // A start with curvature may lead to where there is none.
  if (!flat && stage != Stage::kKnown &&
      (stage == Stage::kValley || degenerate(here_.gauss_newton))) {
    may_be_flat_ = false;
    walk(0);
  }
  outcome.known = stage == Stage::kKnown;
  outcome.valid = !outcome.known;
  outcome.limited = limited_;
  outcome.deviation = here_.value;
  outcome.termination = stage == Stage::kConverged        ? Termination::kConverged
                        : stage == Stage::kIterationLimit ? Termination::kIterationLimit
                                                          : Termination::kNonsmooth;
  return outcome;
}

}  // namespace softfinger
