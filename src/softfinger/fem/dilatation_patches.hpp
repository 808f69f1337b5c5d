#pragma once

#include <span>
#include <vector>

#include "softfinger/geometry/pose.hpp"
#include "softfinger/geometry/tetrahedron_faces.hpp"

namespace softfinger {

/// Divides tetrahedra into patches of about four neighbours over which the change of volume is
/// averaged. Linear tetrahedra each keeping their own volume are far too stiff where Poisson's
/// ratio is near one half (volumetric locking); few constraints per node are not.
///
/// `nodes`: rest positions, m: patches go by where tetrahedra are, not by how they are numbered.
/// `material[t]` of tetrahedron t, -1: in no patch. A patch is connected by faces and of one
/// material. Returns the patch of each tetrahedron, numbered from 0 without gaps; -1 in none.
[[nodiscard]] std::vector<int> dilatation_patches(std::span<const Vector3> nodes,
                                                  std::span<const Tetrahedron> tetrahedra,
                                                  std::span<const int> material);

}  // namespace softfinger
