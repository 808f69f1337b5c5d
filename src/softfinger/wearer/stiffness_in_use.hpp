#pragma once

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// What is left of skin's stress where force grows as exp(rate t), rate in 1/s: a part of what
/// would be without relaxation. Of quasilinear viscoelasticity, see Relaxation.
[[nodiscard]] double stress_of_growing_force(const Relaxation& relaxation, double rate);

/// How much stiffer this finger is at once than it seems while it is pressed at `speed` (m/s), by
/// the relaxation of its file: 1 where it has none.
[[nodiscard]] double stiffness_in_use(const FingerModel& finger, double speed);

}  // namespace softfinger
