#pragma once

#include <cmath>

namespace softfinger {

/// Strain limit as an energy density b(s) of each principal stretch s, added to the elastic one:
/// zero inside [min + width, max - width], then k w^2 t^3 / (1 - t) with t = (s - (max - w)) / w
/// for the upper limit (mirrored for the lower one) up to t = 0.95, its quadratic Taylor polynomial
/// beyond. Twice continuously differentiable and finite everywhere, so no state is infeasible. It
/// stands for the constraints of Perez, Cirio, Hernandez, Garre, Otaduy, "Strain limiting for soft
/// finger contact simulation", World Haptics 2013; the form is ours.
struct StrainLimit {
  double min = 0.0;        ///< least stretch, in (0, 1)
  double max = 0.0;        ///< greatest stretch, above 1
  double stiffness = 0.0;  ///< k, Pa; 0 switches the limits off
  double width = 1.0;      ///< w, in (0, min(1 - min, max - 1)]

  /// b and its first two derivatives, Pa.
  struct Value {
    double energy = 0.0, first = 0.0, second = 0.0;
  };
  [[nodiscard]] Value at(double stretch) const {
    const Value upper = onset((stretch - (max - width)) / width);
    const Value lower = onset(((min + width) - stretch) / width);
    return {stiffness * width * width * (upper.energy + lower.energy),
            stiffness * width * (upper.first - lower.first),
            stiffness * (upper.second + lower.second)};
  }

  /// t^3 / (1 - t) for 0 < t <= 0.95 and its continuation, with derivatives by t.
  [[nodiscard]] static Value onset(double t) {
    if (t <= 0.0) return {};
    const double t0 = std::fmin(t, kSwitch);
    const double q = 1.0 / (1.0 - t0);
    Value v{t0 * t0 * t0 * q, t0 * t0 * (3.0 - 2.0 * t0) * q * q,
            t0 * (6.0 - 6.0 * t0 + 2.0 * t0 * t0) * q * q * q};
    const double beyond = t - t0;
    v.energy += beyond * (v.first + 0.5 * beyond * v.second);
    v.first += beyond * v.second;
    return v;
  }

  static constexpr double kSwitch = 0.95;
};

}  // namespace softfinger
