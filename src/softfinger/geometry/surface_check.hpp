#pragma once

#include <string>

#include "softfinger/geometry/triangle_tree.hpp"
#include "softfinger/threads/parallel_for.hpp"

namespace softfinger {

/// Throws InputError, one line that begins with `source`, where triangles of the surface pass
/// through each other or neighbours lie on each other, where a part of it is inside out, or where
/// one part lies inside another without being its cavity. A corner or an edge that rests on a
/// triangle is no crossing. Runs on all cores.
void check_surface(const ClosedSurface& surface, const TriangleTree& tree,
                   const std::string& source, const Progress& progress = {});

}  // namespace softfinger
