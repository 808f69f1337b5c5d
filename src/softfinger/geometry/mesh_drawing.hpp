#pragma once

#include <cstddef>
#include <stop_token>

#include "softfinger/geometry/signed_distance.hpp"
#include "softfinger/geometry/triangle_mesh.hpp"

namespace softfinger {

/// The mesh, or where it has more than `most` triangles one with fewer for drawing: vertices in the
/// same cell of a grid become one, their mean (Rossignac and Borrel 1993).
/// Throws InputError when `stop` asks for an end.
[[nodiscard]] TriangleMesh drawing_of(const TriangleMesh& mesh, std::size_t most,
                                      const std::stop_token& stop = {});

/// Its surface in rings about the axis.
[[nodiscard]] TriangleMesh drawing_of(const TaperedCapsule& capsule);

}  // namespace softfinger
