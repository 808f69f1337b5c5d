#pragma once

#include <span>

namespace softfinger {

/// Skin samples as the matching hands them to a device: coordinates in F (m), those in contact
/// first. Views; all spans have the same length.
struct SurfaceSamples {
  std::span<const double> x, y, z;
  std::span<const double> weight;  ///< dimensionless, > 0
  std::span<const double> margin;  ///< separation eps_i of the samples not in contact, m, >= 0
  int contact_count = 0;           ///< the first contact_count samples are in C, the others in N

  [[nodiscard]] int size() const { return static_cast<int>(x.size()); }
};

}  // namespace softfinger
