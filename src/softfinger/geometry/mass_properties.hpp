#pragma once

#include <optional>

#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {

/// Moments of an even solid of density 1, in its own frame O.
struct MassProperties {
  double volume = 0.0;                        ///< m^3
  Vector3 centre_O = Vector3::Zero();         ///< m
  Matrix3 second_moment_O = Matrix3::Zero();  ///< integral of x x^T about the centre, m^5
};

/// Of a shape as it is touched, rounded edges included; of a mesh by cells of 1/96 of its longest
/// side, to about 1e-3. Empty where it has no end or no volume.
[[nodiscard]] std::optional<MassProperties> mass_properties(const Shape& shape);

}  // namespace softfinger
