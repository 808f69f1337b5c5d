#pragma once

#include <vector>

#include "softfinger/fem/element_kernels.hpp"

namespace softfinger {

/// Quasilinear viscoelasticity (Fung, "Biomechanics", 1993): stress is that of each past moment,
/// relaxed by G(t) = 1 - sum g_k (1 - exp(-t / tau_k)), a Prony series common to all layers.
struct Relaxation {
  struct Term {
    double fraction;  ///< g, above 0; the sum over all terms is below 1
    double time;      ///< tau, s, above 0
  };
  std::vector<Term> terms;  ///< none: elastic

  /// What is left of the stress after a long time, G(infinity).
  [[nodiscard]] double long_time_fraction() const;
  /// What one step of `time_step` (s) adds of the stress that builds up in it: G averaged over it.
  [[nodiscard]] double step_fraction(double time_step) const;
};

/// Stress that a solid remembers, in the material frame; plain state, all zero at rest.
struct StressHistory {
  std::vector<ElementStress> elastic;                ///< per group, at the end of the last step
  std::vector<std::vector<ElementStress>> relaxing;  ///< per term and group: not relaxed yet
};

[[nodiscard]] StressHistory make_history(const Relaxation& relaxation, std::size_t groups);
void forget(StressHistory& history);
/// memory = the part of the stress at the end of the next step that the past decides.
void recall(const Relaxation& relaxation, const StressHistory& history, double time_step,
            std::vector<ElementStress>& memory);
/// Moves on by `time_step` at whose end the elastic stress of group g is `elastic`.
void remember(const Relaxation& relaxation, double time_step, std::size_t g,
              const ElementStress& elastic, StressHistory& history);

}  // namespace softfinger
