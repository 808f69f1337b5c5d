#pragma once

namespace softfinger {

/// Constants of one layer of tissue.
struct ElasticMaterial {
  double youngs_modulus = 45e3;  ///< E, Pa, positive
  double poissons_ratio = 0.4;   ///< nu, in (0, 0.5)
  double density = 1000.0;       ///< kg/m^3, positive

  /// Lame's constants, Pa: those of the constitutive law.
  [[nodiscard]] double mu() const { return youngs_modulus / (2.0 * (1.0 + poissons_ratio)); }
  [[nodiscard]] double lambda() const {
    return youngs_modulus * poissons_ratio /
           ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio));
  }
};

}  // namespace softfinger
