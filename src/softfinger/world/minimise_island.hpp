#pragma once

#include <algorithm>

#include "softfinger/finger/minimise_in_cone.hpp"

namespace softfinger {

/// As minimise_in_cone(), of an IslandProblem, where a finger's friction limits and those of all
/// that it holds hang together: passes that lower the limits go only so far that what is left is
/// small against what the lowering has changed, and lower them further the more slowly the friction
/// beyond the cone shrinks from pass to pass, as a fixed point of that rate asks for (Aitken).
template <typename Problem>
NewtonSummary minimise_island(Problem& problem, const NewtonOptions& options) {
  constexpr int kConePasses = 40;
  constexpr double kPart = 0.3;  ///< of the residual that new limits leave
  constexpr double kSlowest = 0.95;
  constexpr double kLeast = ContactPotential::kOvershoot;
  constexpr double kMost = 8.0;
  NewtonOptions rough = options;
  const double roughly = std::max(options.tolerance, 1e-2);
  rough.tolerance = roughly;
  NewtonSummary summary = untangle_and_minimise(problem, rough);
  const auto go_on = [&](const NewtonOptions& to) {
    const NewtonSummary again = minimise(problem, to);
    summary.iterations += again.iterations;
    summary.factorisations += again.factorisations;
    summary.converged = again.converged;
    summary.residual = again.residual;
  };
  double overshoot = kLeast;
  double before = 0.0;  // friction beyond the cone in the pass before
  for (int pass = 0;; ++pass) {
    problem.settle();
    const bool last = pass == kConePasses;
    if (last || (pass > 0 && problem.is_in_cone())) {
      go_on(options);
      problem.settle();
      const bool inside = problem.is_in_cone();
      summary.converged = summary.converged && inside;
      if (last || inside) return summary;
    }
    const double beyond = problem.beyond_cone();
    if (before > 0.0) {
      const double rate = std::clamp(beyond / before, 0.0, kSlowest);
      overshoot = std::clamp((1.0 + overshoot) / (1.0 - rate) - 1.0, kLeast, kMost);
    }
    // Limits that only fall come to an end; in the first pass they may rise.
    problem.update_limits(pass > 0, overshoot);
    before = pass > 0 ? beyond : 0.0;
    problem.renew();
    rough.tolerance = std::clamp(kPart * problem.residual(), options.tolerance, roughly);
    go_on(rough);
  }
}

}  // namespace softfinger
