#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace softfinger {

using Tetrahedron = std::array<int, 4>;
using Triangle = std::array<int, 3>;

/// One face of one tetrahedron.
struct TetrahedronFace {
  Triangle sorted;   ///< node indices in rising order
  Triangle outward;  ///< the same, counterclockwise as seen from outside the tetrahedron
  int tetrahedron;
};

/// The four faces of every tetrahedron (right-handed ones), ordered by `sorted`, so that a face
/// shared by two tetrahedra stands twice in a row.
[[nodiscard]] std::vector<TetrahedronFace> faces_of(std::span<const Tetrahedron> tetrahedra);
/// Node indices in rising order.
[[nodiscard]] Triangle sorted(Triangle triangle);
/// Of `faces` as from faces_of(), those with the nodes of `triangle`, in any order.
[[nodiscard]] std::span<const TetrahedronFace> find_face(std::span<const TetrahedronFace> faces,
                                                         const Triangle& triangle);

/// A place where tetrahedra do not form a solid with a clean surface.
struct MeshDefect {
  std::string message;     ///< what is wrong there
  std::vector<int> nodes;  ///< node indices concerned
  int tetrahedron;         ///< one of the tetrahedra concerned
};
/// First defect found: a face of more than two tetrahedra, two tetrahedra on the same side of a
/// face, an edge or node where more than one sheet of the boundary meets. Empty message if none.
[[nodiscard]] MeshDefect find_boundary_defect(std::span<const TetrahedronFace> faces);

}  // namespace softfinger
