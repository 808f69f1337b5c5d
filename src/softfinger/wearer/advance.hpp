#pragma once

#include "softfinger/device/device.hpp"

namespace softfinger {

/// A configuration advanced towards the finger, m.
[[nodiscard]] Configuration advanced(const Device& device, const Configuration& from, double by);

/// How far q is advanced from another, m.
[[nodiscard]] double advance_between(const Device& device, const Configuration& from,
                                     const Configuration& q);

/// Moves q towards a goal by a step of the surface's motion, m; true where it is there.
bool step_towards(const Device& device, const Configuration& goal, double step, Configuration& q);

}  // namespace softfinger
