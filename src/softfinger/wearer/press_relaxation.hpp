#pragma once

#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/wearer/press_reading.hpp"

namespace softfinger {

/// Of the force of a finger pad by depth, 1/m: exp(m d) with m = 2.1 /mm (Pawluk and Howe 1999).
inline constexpr double kForceGrowth = 2.1 / mm;

/// What is left of skin's stress where force grows as exp(rate t), rate in 1/s: a part of what
/// would be without relaxation. Of quasilinear viscoelasticity, see Relaxation.
[[nodiscard]] double stress_of_growing_force(const Relaxation& relaxation, double rate);

/// How much stiffer a finger is at once than it seems at a touch as it is neared at `speed` (m/s),
/// by the relaxation of its file: 1 where it has none.
[[nodiscard]] double stiffness_in_use(const FingerModel& finger, double speed);

/// Presses, one after the other, as they would be felt of skin that does not relax, at the same
/// advance: each force with what has been lost of it, of those before and of the presses before,
/// between which the skin recovers. Readings have their times, in order, and begin off the skin.
[[nodiscard]] std::vector<PressRecord> without_relaxation(std::vector<PressRecord> presses,
                                                          const Relaxation& relaxation);

}  // namespace softfinger
