#pragma once

#include <algorithm>
#include <cmath>
#include <stop_token>

namespace softfinger {

/// What the second derivative keeps, from best to safest: everything; everything but the curvature
/// of contact surfaces; only what is positive semidefinite by construction.
enum class HessianKind { kFull, kNoContactCurvature, kProjected };

struct NewtonOptions {
  double tolerance = 1e-6;  ///< ends when residual <= tolerance
  int max_iterations = 60;  ///< an overrun guard; reaching it is reported
  /// A factor is used again while each iteration reduces the residual by more than this (chord
  /// steps); set very large to factor in every iteration.
  double chord_reduction = 5.0;
  std::stop_token stop = {};  ///< asks for an end at the next iteration, as at max_iterations
};

struct NewtonSummary {
  int iterations = 0;
  int factorisations = 0;
  bool converged = false;
  double residual = 0.0;
};

/// Minimises a smooth energy by Newton's method with a line search, full Hessian first and safer
/// ones where it is not positive definite, and chord steps that reuse the last factor.
///
/// Problem:
///   double energy(), residual()      of the current point, which has been evaluated;
///   bool has_factor()                whether solve_direction() can be used as it is;
///   bool factorise(HessianKind)      at the current point; false if not positive definite;
///   double solve_direction(bool refined)  sets d = -A^-1 g, better if `refined`; returns g . d;
///   void evaluate_trial(double t)    at current + t d;
///   double trial_energy(), trial_residual();
///   void accept_trial().
template <typename Problem>
NewtonSummary minimise(Problem& problem, const NewtonOptions& options) {
  constexpr double kArmijo = 1e-4;
  // Near the minimum energy differences drown in rounding; there the residual decides. Where they
  // do not, a smaller residual at a higher energy is the way to a saddle.
  constexpr double kEnergySlack = 1e-13;
  constexpr double kEnergyRounding = 1e-10;  // of a strain energy whose strains are 1e-6
  constexpr int kMaxHalvings = 24;
  constexpr double kConcave = 0.75;  // of the slope; a quadratic's minimum has 1/2
  constexpr double kStretch = 4.0;
  constexpr double kLongestStep = 256.0;

  NewtonSummary summary;
  bool reuse = problem.has_factor();
  bool refined = true;
  HessianKind least = HessianKind::kFull;
  while (true) {
    summary.residual = problem.residual();
    summary.converged = summary.residual <= options.tolerance;
    const bool enough =
        summary.iterations >= options.max_iterations || options.stop.stop_requested();
    if (summary.converged || enough) return summary;

    HessianKind kind = least;
    if (!reuse) {
      while (!problem.factorise(kind)) {
        if (kind == HessianKind::kProjected) return summary;
        kind =
            kind == HessianKind::kFull ? HessianKind::kNoContactCurvature : HessianKind::kProjected;
      }
      ++summary.factorisations;
    }
    ++summary.iterations;
    const double slope = problem.solve_direction(refined);
    const double energy = problem.energy();
    const double residual = summary.residual;
    bool accepted = false;
    double t = 1.0;
    const int halvings = reuse || refined ? 0 : kMaxHalvings;
    for (int halving = 0; slope < 0.0 && halving <= halvings; ++halving, t *= 0.5) {
      problem.evaluate_trial(t);
      const double e = problem.trial_energy();
      const double r = problem.trial_residual();
      if (!std::isfinite(e) || !std::isfinite(r)) continue;
      const bool lower = e <= energy + kArmijo * t * slope + kEnergySlack * std::abs(energy);
      const bool closer = r <= 0.5 * residual && e <= energy + kEnergyRounding * std::abs(energy);
      if (lower || closer) {
        accepted = true;
        break;
      }
    }
    // A decrease as steep as the slope all the way: the energy is concave along the direction, near
    // a saddle that unit steps would leave slowly.
    if (accepted && kind != HessianKind::kFull && t == 1.0 && !reuse) {
      double lowest = problem.trial_energy();
      double longest = t;
      while (longest < kLongestStep && lowest - energy < kConcave * longest * slope) {
        problem.evaluate_trial(kStretch * longest);
        if (!(problem.trial_energy() < lowest)) break;
        lowest = problem.trial_energy();
        longest *= kStretch;
      }
      if (problem.trial_energy() != lowest) problem.evaluate_trial(longest);
    }
    if (accepted) {
      problem.accept_trial();
      reuse = residual > options.chord_reduction * problem.residual();
      continue;
    }
    if (refined) {
      refined = false;  // what was to be better misled
      reuse = reuse && problem.has_factor();
      continue;
    }
    if (reuse) {
      reuse = false;  // the old factor misled: a fresh one, from the same point
      continue;
    }
    if (kind == HessianKind::kProjected) return summary;
    least = HessianKind::kProjected;
  }
}

}  // namespace softfinger
