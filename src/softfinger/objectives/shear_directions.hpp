#pragma once

#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// Projection (3 x 3, of vectors in F) onto the directions in which a device can move its surface
/// along itself, and so shear the skin, without moving it towards the finger: at its home, where
/// each of its pieces is nearest to the resting skin. Zero for a device that only presses and
/// tilts; what a linkage moves aside by tilting does not count.
[[nodiscard]] Matrix3 shear_projection(const FingerModel& model, const Device& device);

}  // namespace softfinger
