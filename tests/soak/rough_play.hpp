#pragma once

#include <cstdint>

namespace softfinger {

/// Two fingers in violent motion among objects that they throw, squeeze, drop and are tracked into,
/// so many steps in rounds of five seconds; then they are gone, and all comes to rest by itself.
/// Rounds are drawn by a seed each, this one and those after it, and played on all processors.
/// Prints what happened, so far after every 20 rounds and in the end, and how to repeat a round
/// that was not sound, or slow. False where a state was not finite, something went through the
/// table or deeper into it than it may, what was left alone gained energy, or more than one step in
/// a hundred of a round did not converge.
bool play_roughly(long steps, std::uint64_t seed);

}  // namespace softfinger
