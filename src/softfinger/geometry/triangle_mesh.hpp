#pragma once

#include <array>
#include <vector>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Triangles over shared vertices, counter-clockwise seen from outside. Coordinates in m.
struct TriangleMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace softfinger
