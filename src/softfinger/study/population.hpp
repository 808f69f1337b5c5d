#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

class ConfigTable;

/// How one person's finger differs from the finger file's: factors.
struct PersonFactors {
  double length = 1.0, breadth = 1.0, depth = 1.0;
  double modulus = 1.0;  ///< of all that makes the tissue stiff

  [[nodiscard]] bool operator==(const PersonFactors&) const = default;
};

/// `[population]`: the people that every design is worn by.
struct Population {
  int size = 1;
  std::uint32_t seed = 1;
  /// Standard deviations, fractions of the finger file's. Of length: Chatzioglou et al. 2024, Anat
  /// Cell Biol 57:172, index fingers; the rest, with its reasons, is ours: docs/studies.md.
  double length_sd = 0.06, breadth_sd = 0.07, depth_sd = 0.08, modulus_sd = 0.35;
  double size_correlation = 0.7;     ///< between each two of the sizes
  double modulus_correlation = 0.0;  ///< between the modulus and each size
  /// The simulated finger is the wearer's own; else the finger file's, whoever wears the device.
  bool fitted = true;
};

[[nodiscard]] Population read_population(const ConfigTable& table);

/// Each person, always the same for the same population; of one alone, the finger file's. Sizes
/// are drawn from a normal distribution within 2.5 standard deviations, the modulus from a
/// lognormal one.
[[nodiscard]] std::vector<PersonFactors> draw_people(const Population& population);

/// That person's finger.
[[nodiscard]] std::shared_ptr<const FingerModel> finger_of(
    const std::shared_ptr<const FingerModel>& model, const PersonFactors& person,
    const std::string& text);

}  // namespace softfinger
