#pragma once

#include <cstdint>

namespace softfinger {

/// A long violent run of the whole way from pose to command, in the three named scenes by turns,
/// with and without the limit on the tracked pose's speed that a run has, and no wall clock in it;
/// then fingers whose nodes are scrambled, and presses to 4 mm. Prints how the steps converged and
/// what they took; false when a state was not finite, a command left its bounds, more than one step
/// in a thousand did not converge, an element was left inside out, or a finger did not come back to
/// where it was.
[[nodiscard]] bool explore_violently(long steps, std::uint64_t seed);

}  // namespace softfinger
