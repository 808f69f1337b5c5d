#pragma once

#include <vector>

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// Points of the resting skin, close enough to each other that a small tip meets it between them no
/// deeper than at them: corners of its triangles, middles of their sides, and their centroids; in
/// F, m.
[[nodiscard]] std::vector<Vector3> rest_skin_points(const FingerModel& model);

}  // namespace softfinger
