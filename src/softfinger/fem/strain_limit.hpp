#pragma once

namespace softfinger {

/// Strain limit as an energy density b(s) of each principal stretch s, added to the elastic one:
/// zero inside [min + width, max - width], then k w^2 t^3 / (1 - t) with t = (s - (max - w)) / w
/// for the upper limit (mirrored for the lower one) up to t = 0.95, its quadratic Taylor polynomial
/// beyond. Twice continuously differentiable and finite everywhere, so no state is infeasible. It
/// stands for the constraints of Perez, Cirio, Hernandez, Garre, Otaduy, "Strain limiting for soft
/// finger contact simulation", World Haptics 2013; the form is ours.
struct StrainLimit {
  double min = 0.35;       ///< least stretch, in (0, 1)
  double max = 1.5;        ///< greatest stretch, above 1
  double stiffness = 0.0;  ///< k, Pa; 0: there are no limits
  double width = 0.5;      ///< w, in (0, min(1 - min, max - 1)]
};

/// b and its first two derivatives, Pa.
template <typename Number>
struct StrainLimitResponse {
  Number energy, first, second;
};

/// t^3 / (1 - t) for 0 < t <= 0.95 and its continuation, with derivatives by t. For Arithmetic see
/// constitutive_law.hpp.
template <typename Arithmetic>
inline StrainLimitResponse<typename Arithmetic::Number> strain_limit_onset(
    typename Arithmetic::Number t) {
  using Number = typename Arithmetic::Number;
  const Number zero{};
  const Number t0 = Arithmetic::max(Arithmetic::min(t, Arithmetic::all(0.95)), zero);
  const Number q = 1.0 / (1.0 - t0);
  const Number beyond = Arithmetic::max(t - t0, zero);
  StrainLimitResponse<Number> b;
  b.second = t0 * (6.0 - 6.0 * t0 + 2.0 * t0 * t0) * q * q * q;
  const Number first = t0 * t0 * (3.0 - 2.0 * t0) * q * q;
  b.energy = t0 * t0 * t0 * q + beyond * (first + 0.5 * beyond * b.second);
  b.first = first + beyond * b.second;
  return b;
}

template <typename Arithmetic>
inline StrainLimitResponse<typename Arithmetic::Number> strain_limit_at(
    const StrainLimit& limit, typename Arithmetic::Number s) {
  using Number = typename Arithmetic::Number;
  // The onsets do not overlap: width is at most min(1 - min, max - 1).
  const double w = limit.width;
  const auto above = s > 1.0;
  const Number sign = Arithmetic::select(above, Arithmetic::all(1.0), Arithmetic::all(-1.0));
  const Number reached = Arithmetic::select(above, s - (limit.max - w), (limit.min + w) - s);
  const StrainLimitResponse<Number> b =
      strain_limit_onset<Arithmetic>(Arithmetic::quotient(reached, w));
  const double k = limit.stiffness;
  return {(k * w * w) * b.energy, (k * w) * b.first * sign, k * b.second};
}

}  // namespace softfinger
