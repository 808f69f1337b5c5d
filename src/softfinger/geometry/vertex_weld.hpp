#pragma once

#include <stop_token>

#include "softfinger/geometry/triangle_mesh.hpp"

namespace softfinger {

/// Joins vertices at the same place, as formats without shared vertices (STL) and seams need.
/// Equal coordinates are joined everywhere; on edges that then belong to one triangle only,
/// vertices nearer than `tolerance` (m) are joined as well, which closes cracks of rounding.
/// Triangles that lose a corner are dropped, as are vertices that nothing uses. Order is kept.
/// Throws InputError when `stop` asks for an end.
[[nodiscard]] TriangleMesh welded(const TriangleMesh& mesh, double tolerance,
                                  const std::stop_token& stop = {});

}  // namespace softfinger
