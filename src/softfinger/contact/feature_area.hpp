#pragma once

#include <array>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Which part of a triangle is nearer to the point of it with these barycentric weights than to any
/// corner: 0 to 1. A point at a corner stands for that one; 0 of a triangle without area.
[[nodiscard]] double part_nearer_than_corners(const std::array<Vector3, 3>& corners,
                                              const std::array<double, 3>& weights);

}  // namespace softfinger
