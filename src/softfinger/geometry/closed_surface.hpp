#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "softfinger/geometry/triangle_mesh.hpp"

namespace softfinger {

/// The boundary of a solid: every edge belongs to two triangles that run along it in opposite
/// directions. May consist of several separate surfaces.
struct ClosedSurface {
  TriangleMesh mesh;
  /// Per triangle (v0, v1, v2) the triangles across its edges v0 v1, v1 v2, v2 v0.
  std::vector<std::array<int, 3>> neighbours;
  /// Per triangle, which connected part of the surface it belongs to: 0, 1, ...
  std::vector<int> part;
  std::vector<double> part_volume;  ///< m^3, negative for cavities

  [[nodiscard]] const Vector3& corner(int triangle, int k) const {
    const auto vertex =
        mesh.triangles[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(k)];
    return mesh.positions[static_cast<std::size_t>(vertex)];
  }
};

/// A point as messages name it: "(1, 2.5, -3) mm"; p in m.
[[nodiscard]] std::string place_in_mm(const Vector3& p);

/// Takes a welded mesh. Throws InputError, one line that begins with `source`, where the surface is
/// open, branches, changes its orientation, encloses no volume or is inside out; places are in mm.
/// And when `stop` asks for an end.
[[nodiscard]] ClosedSurface closed_surface(TriangleMesh mesh, const std::string& source,
                                           const std::stop_token& stop = {});

}  // namespace softfinger
