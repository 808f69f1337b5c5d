#pragma once

#include <array>
#include <random>

#include "softfinger/geometry/tetrahedral_mesh.hpp"

namespace softfinger::testing_support {

/// A box of nx x ny x nz cubes of six tetrahedra each (Kuhn), lower corner at `origin`. Every
/// boundary triangle is in surface 0 "skin", but those at z = top in surface 1 "bone".
inline TetrahedralMesh box_mesh(int nx, int ny, int nz, const Vector3& origin,
                                const Vector3& size) {
  TetrahedralMesh mesh;
  mesh.volume_names = {"tissue"};
  mesh.surface_names = {"skin", "bone"};
  const auto node = [&](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        mesh.nodes.push_back(origin + size.cwiseProduct(Vector3(static_cast<double>(i) / nx,
                                                                static_cast<double>(j) / ny,
                                                                static_cast<double>(k) / nz)));
      }
    }
  }
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        for (std::size_t o = 0; o < kOrders.size(); ++o) {
          std::array<int, 3> at{i, j, k};
          std::array<int, 4> t{node(i, j, k), 0, 0, 0};
          for (std::size_t s = 0; s < 3; ++s) {
            ++at[static_cast<std::size_t>(kOrders[o][s])];
            t[s + 1] = node(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(t[2], t[3]);  // odd orders are mirrored
          mesh.tetrahedra.push_back(t);
          mesh.tetrahedron_volume.push_back(0);
        }
      }
    }
  }
  // Boundary: faces of one tetrahedron only.
  constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
      {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::vector<std::array<int, 3>> faces;
  for (const auto& t : mesh.tetrahedra) {
    for (const auto& f : kFaces) faces.push_back({t[f[0]], t[f[1]], t[f[2]]});
  }
  const auto sorted = [](std::array<int, 3> f) {
    std::sort(f.begin(), f.end());
    return f;
  };
  std::sort(faces.begin(), faces.end(),
            [&](const auto& a, const auto& b) { return sorted(a) < sorted(b); });
  const double top = origin.z() + size.z();
  for (std::size_t f = 0; f < faces.size();) {
    std::size_t same = f + 1;
    while (same < faces.size() && sorted(faces[same]) == sorted(faces[f])) ++same;
    if (same == f + 1) {
      bool on_top = true;
      for (int n : faces[f]) {
        on_top = on_top && std::abs(mesh.nodes[static_cast<std::size_t>(n)].z() - top) < 1e-12;
      }
      mesh.triangles.push_back(faces[f]);
      mesh.triangle_surface.push_back(on_top ? 1 : 0);
    }
    f = same;
  }
  return mesh;
}

inline void displace(std::vector<Vector3>& points, double amplitude, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> offset(-amplitude, amplitude);
  // One by one: in which order arguments are evaluated is the compiler's choice.
  for (Vector3& p : points) {
    for (const int axis : {2, 1, 0}) p[axis] += offset(generator);
  }
}

}  // namespace softfinger::testing_support
