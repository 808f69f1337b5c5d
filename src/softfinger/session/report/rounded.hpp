#pragma once

#include <array>
#include <cmath>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// A multiple of a millionth, never -0: what is printed is more than anybody measures.
inline double micro_rounded(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

/// The same of a vector, in a unit.
inline std::array<double, 3> micro_rounded(const Vector3& vector, double unit) {
  return {micro_rounded(vector.x() / unit), micro_rounded(vector.y() / unit),
          micro_rounded(vector.z() / unit)};
}

}  // namespace softfinger
