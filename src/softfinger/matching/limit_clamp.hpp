#pragma once

#include "softfinger/device/device.hpp"

namespace softfinger {

/// Brings a configuration into the workspace after the fact (Perez et al. 2015): joint angles by
/// inverse kinematics cut to what exists and to the limits, then the configuration that has them;
/// where there is none, the last reachable point on the segment from home to `wanted`.
[[nodiscard]] Configuration clamped_to_limits(const Device& device, const Configuration& wanted);

/// Last point of the segment from `from`, which is reachable, to `to` before it leaves the
/// workspace.
[[nodiscard]] Configuration last_reachable(const Device& device, const Configuration& from,
                                           const Configuration& to);

}  // namespace softfinger
