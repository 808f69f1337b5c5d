#pragma once

#include <string>

#include "softfinger/geometry/signed_distance_grid.hpp"
#include "softfinger/geometry/triangle_tree.hpp"
#include "softfinger/threads/parallel_for.hpp"

namespace softfinger {

/// Samples the distance to a surface on grids of `spacing` (m) and its doubles, on all cores; the
/// result does not depend on their number. The domain reaches `margin` (m) beyond the surface.
/// `drawing` stays empty. Throws InputError, beginning with `source`, where the finest grid would
/// have more than a fixed number of blocks; it names the spacing that would do.
[[nodiscard]] SignedDistanceGrid::Content sample_distance(const ClosedSurface& surface,
                                                          const TriangleTree& tree, double spacing,
                                                          double margin, const std::string& source,
                                                          const Progress& progress = {});

}  // namespace softfinger
