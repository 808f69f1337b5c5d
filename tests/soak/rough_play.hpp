#pragma once

#include <cstdint>

namespace softfinger {

/// Two fingers in violent motion among objects that they throw, squeeze, drop and are tracked into,
/// so many steps in rounds of five seconds; then they are gone, and all comes to rest by itself.
/// Prints what happened, so far after every 100,000 steps and in the end. False where a state was
/// not finite, something went through the table or deeper into it than it may, what was left alone
/// gained energy, or more than one step in a hundred did not converge.
bool play_roughly(long steps, std::uint64_t seed);

}  // namespace softfinger
