#pragma once

#include <filesystem>

#include "softfinger/geometry/tetrahedral_mesh.hpp"

namespace softfinger {

/// Reads a Gmsh MSH 2.2 ASCII file; `scale` is metres per file unit (1e-3 for mm). Unused nodes are
/// dropped; tetrahedra and triangles come back with the orientation promised by TetrahedralMesh.
/// Throws InputError with file and line for: MSH 4.x or binary files (says how to convert), damaged
/// or truncated files, no tetrahedra (a surface mesh), inverted or degenerate elements, a group
/// triangle that is no face of a tetrahedron, a boundary that is not a manifold. No locale.
[[nodiscard]] TetrahedralMesh read_msh(const std::filesystem::path& file, double scale);

}  // namespace softfinger
