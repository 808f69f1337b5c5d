#pragma once

namespace softfinger {

/// St. Venant and Kirchhoff's: with E_i = (s_i^2 - 1) / 2, Psi = mu sum E_i^2 + lambda/2 d^2 and
/// d = sum E_i. Unlike the corotated law's, neither part is linear in the stretches.
template <typename Arithmetic>
class GreenLaw {
 public:
  using Number = typename Arithmetic::Number;
  static Number dilatation(const Number (&s)[3]) {
    return strain(s[0]) + strain(s[1]) + strain(s[2]);
  }
  GreenLaw(Number mu, Number lambda, const Number (&s)[3], Number dilatation, Number pressure)
      : mu_(mu),
        lambda_(lambda),
        s_{s[0], s[1], s[2]},
        dilatation_(dilatation),
        pressed_(lambda * dilatation + pressure) {}
  Number energy() const {
    return energy_along(0) + energy_along(1) + energy_along(2) + energy_of_dilatation();
  }
  Number energy_of_dilatation() const {
    return Arithmetic::all(0.5) * lambda_ * dilatation_ * dilatation_;
  }
  Number energy_along(int i) const { return mu_ * strain(s_[i]) * strain(s_[i]); }
  Number stress(int i) const {
    return Arithmetic::all(2.0) * mu_ * strain(s_[i]) * s_[i] + lambda_ * dilatation_ * s_[i];
  }
  Number dilatation_slope(int i) const { return s_[i]; }
  Number stiffness(int i, int j) const {
    const Number both = lambda_ * s_[i] * s_[j];
    if (i != j) return both;
    return both + pressed_ + mu_ * (Arithmetic::all(3.0) * s_[i] * s_[i] - Arithmetic::all(1.0));
  }
  Number flip(int i, int j) const {
    return pressed_ + mu_ * (s_[i] * s_[i] + s_[i] * s_[j] + s_[j] * s_[j] - Arithmetic::all(1.0));
  }

 private:
  static Number strain(Number s) { return Arithmetic::all(0.5) * (s * s - Arithmetic::all(1.0)); }
  Number mu_, lambda_;
  Number s_[3];
  Number dilatation_, pressed_;
};

}  // namespace softfinger
