#pragma once

#include <algorithm>

#include "softfinger/numerics/newton.hpp"

namespace softfinger {

// Problems are those of numerics/newton.hpp that have skin in them: besides they are asked
//   bool is_tangled(), void limit_strain(bool), void settle(), void renew(),
//   bool is_in_cone(), void update_limits(bool only_lower)
// as of FingerPotential.

/// Minimises from where the problem stands. Strain limits turn states with elements inside out into
/// minima of their own; from such a start the minimum without limits is sought first, from which
/// the wanted one is near.
template <typename Problem>
NewtonSummary untangle_and_minimise(Problem& problem, const NewtonOptions& options) {
  int iterations = 0;
  int factorisations = 0;
  if (problem.is_tangled()) {
    problem.limit_strain(false);
    const NewtonSummary untangled = minimise(problem, options);
    problem.limit_strain(true);
    iterations = untangled.iterations;
    factorisations = untangled.factorisations;
  }
  NewtonSummary summary = minimise(problem, options);
  summary.iterations += iterations;
  summary.factorisations += factorisations;
  return summary;
}

/// The same, and where friction is then outside the cone of the normal forces found, again with the
/// limits of the step's anchors brought down to these, until it is inside; if that does not come to
/// an end the summary says that it did not converge.
template <typename Problem>
NewtonSummary minimise_in_cone(Problem& problem, const NewtonOptions& options) {
  constexpr int kConePasses = 40;
  // Residual to which a pass goes before friction limits are looked at: they are nearly final
  // there.
  constexpr double kRoughly = 1e-2;
  NewtonOptions rough = options;
  rough.tolerance = std::max(options.tolerance, kRoughly);
  NewtonSummary summary = untangle_and_minimise(problem, rough);
  int pass = 0;
  for (bool fully = false;;) {
    problem.settle();
    const bool inside = problem.is_in_cone();
    const bool last = inside || pass == kConePasses;
    if (fully && last) {
      summary.converged = summary.converged && inside;
      return summary;
    }
    fully = last;
    if (!fully) {
      // Limits that only fall come to an end.
      problem.update_limits(pass > 0);
      problem.renew();
      ++pass;
    }
    const NewtonSummary again = minimise(problem, fully ? options : rough);
    summary.iterations += again.iterations;
    summary.factorisations += again.factorisations;
    summary.converged = again.converged;
    summary.residual = again.residual;
  }
}

}  // namespace softfinger
