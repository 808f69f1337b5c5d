#pragma once

#include "softfinger/geometry/pose.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {

/// X_WBody of a body tracked as X_KBody in a right-handed frame K: for up = z K's axes are W's; for
/// up = y they are turned so that x_W = -z_K, y_W = -x_K, z_W = y_K, the body's own axes with them.
[[nodiscard]] Pose world_from_tracker(UpAxis up, const Pose& X_KBody);
/// The reverse.
[[nodiscard]] Pose tracker_from_world(UpAxis up, const Pose& X_WBody);

}  // namespace softfinger
