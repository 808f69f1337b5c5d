#pragma once

#include <array>
#include <string>
#include <vector>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Tetrahedra with named groups. Right-handed: (p1-p0) x (p2-p0) . (p3-p0) > 0. Coordinates in m.
struct TetrahedralMesh {
  std::vector<Vector3> nodes;
  std::vector<std::array<int, 4>> tetrahedra;
  std::vector<int> tetrahedron_volume;        ///< per tetrahedron, index into volume_names
  std::vector<std::string> volume_names;      ///< physical volumes, e.g. "tissue"
  std::vector<std::array<int, 3>> triangles;  ///< triangles of the physical surfaces, outward
  std::vector<int> triangle_surface;          ///< per triangle, index into surface_names
  std::vector<std::string> surface_names;     ///< physical surfaces: "skin", "bone", "nail"
};

}  // namespace softfinger
