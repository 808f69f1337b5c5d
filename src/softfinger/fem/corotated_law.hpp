#pragma once

namespace softfinger {

/// Corotated linear elasticity in the principal stretches s_i:
///
///   Psi = mu sum (s_i - 1)^2 + lambda/2 d^2,  d = sum (s_i - 1).
///
/// What its functions are for, and for Arithmetic, see constitutive_law.hpp.
template <typename Arithmetic>
class CorotatedLaw {
 public:
  using Number = typename Arithmetic::Number;

  [[nodiscard]] static Number dilatation(const Number (&s)[3]) {
    return Arithmetic::sum_of_strains(s);
  }

  /// The dilatation is linear: a pressure on it does not change how stresses grow.
  CorotatedLaw(Number mu, Number lambda, const Number (&s)[3], Number dilatation,
               Number /*pressure*/)
      : mu_(mu),
        lambda_(lambda),
        strain_{s[0] - Arithmetic::all(1.0), s[1] - Arithmetic::all(1.0),
                s[2] - Arithmetic::all(1.0)},
        dilatation_(dilatation) {}

  [[nodiscard]] Number energy() const {
    const auto& e = strain_;
    return mu_ * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + energy_of_dilatation();
  }
  [[nodiscard]] Number energy_of_dilatation() const {
    return 0.5 * lambda_ * dilatation_ * dilatation_;
  }
  [[nodiscard]] Number energy_along(int i) const { return mu_ * strain_[i] * strain_[i]; }
  [[nodiscard]] Number stress(int i) const {
    return 2.0 * mu_ * strain_[i] + lambda_ * dilatation_;
  }
  [[nodiscard]] Number dilatation_slope(int /*i*/) const { return Arithmetic::all(1.0); }
  [[nodiscard]] Number stiffness(int i, int j) const {
    return i == j ? 2.0 * mu_ + lambda_ : lambda_;
  }
  [[nodiscard]] Number flip(int /*i*/, int /*j*/) const { return 2.0 * mu_; }

 private:
  Number mu_, lambda_;
  Number strain_[3];
  Number dilatation_;
};

}  // namespace softfinger
