#include <algorithm>
#include <array>
#include <cmath>

#include "scratch_file.hpp"
#include "softfinger/geometry/grid_sampling.hpp"
#include "softfinger/geometry/surface_check.hpp"
#include "softfinger/geometry/vertex_weld.hpp"

namespace {

using namespace softfinger;

/// An octahedron of which the input moves corners, divides and adds triangles.
TriangleMesh mesh_of(const std::uint8_t* data, std::size_t size) {
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (; size >= 4; data += 4, size -= 4) {
    const auto signed_at = [&](int k) { return (data[k] - 128) / 64.0; };
    const std::size_t vertex = data[0] / 4 % mesh.positions.size();
    const std::size_t triangle = data[0] / 4 % mesh.triangles.size();
    const std::array<int, 3> t = mesh.triangles[triangle];
    const auto fresh = static_cast<int>(mesh.positions.size());
    switch (data[0] % 4) {
      case 0:
        mesh.positions[vertex] += Vector3(signed_at(1), signed_at(2), signed_at(3));
        break;
      case 1:  // in the triangle's middle
        mesh.positions.emplace_back(Vector3(signed_at(1), signed_at(2), signed_at(3)));
        mesh.triangles[triangle] = {t[0], t[1], fresh};
        mesh.triangles.push_back({t[1], t[2], fresh});
        mesh.triangles.push_back({t[2], t[0], fresh});
        break;
      case 2:  // two vertices become one
        mesh.positions[vertex] = mesh.positions[data[1] % mesh.positions.size()];
        break;
      default:
        mesh.triangles.push_back({data[1] % fresh, data[2] % fresh, data[3] % fresh});
    }
  }
  return mesh;
}

}  // namespace

extern "C" int fuzz_mesh_surface(const std::uint8_t* data, std::size_t size) {
  if (size > 400) return 0;
  read_or_refuse([&] {
    const ClosedSurface surface = closed_surface(welded(mesh_of(data, size), 1e-6), "mesh");
    const TriangleTree tree(surface);
    check_surface(surface, tree, "mesh");
    const SignedDistanceGrid grid(sample_distance(surface, tree, 0.2, 0.3, "mesh"), "mesh", 0);
    for (int i = 0; i < 20; ++i) {
      const Vector3 p(std::sin(1.0 * i), std::cos(2.0 * i), std::sin(3.0 * i));
      const SignedDistance at = grid.signed_distance(p);
      if (!std::isfinite(at.distance) || !at.gradient.allFinite() || !at.hessian.allFinite()) {
        __builtin_trap();
      }
      // Never farther off than the finest grid at work there explains.
      if (std::abs(at.distance - tree.closest(p).distance) > 0.4 + 0.5 * std::abs(at.distance)) {
        __builtin_trap();
      }
    }
  });
  return 0;
}
