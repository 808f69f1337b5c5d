#pragma once

#include <cmath>

namespace softfinger {

/// A multiple of a millionth, never -0: what is printed is more than anybody measures.
inline double micro_rounded(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

}  // namespace softfinger
