#pragma once

#include <array>
#include <memory>

#include "play.hpp"
#include "softfinger/finger/soft_solid.hpp"
#include "softfinger/geometry/tetrahedron_faces.hpp"

namespace softfinger {

/// A box of `cells` a side, each of six tetrahedra about its diagonal; O is in its centre. All of
/// its outside touches; nodes of its lowest face are held where `held`.
inline std::shared_ptr<const SoftSolid> soft_box(const Vector3& size,
                                                 const std::array<int, 3>& cells, double modulus,
                                                 double poissons_ratio, double density,
                                                 bool held = false) {
  auto solid = std::make_shared<SoftSolid>();
  const auto node = [&](int i, int j, int k) {
    return (i * (cells[1] + 1) + j) * (cells[2] + 1) + k;
  };
  for (int i = 0; i <= cells[0]; ++i) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int k = 0; k <= cells[2]; ++k) {
        const Vector3 part(i / static_cast<double>(cells[0]), j / static_cast<double>(cells[1]),
                           k / static_cast<double>(cells[2]));
        solid->mesh.nodes.push_back((part - Vector3::Constant(0.5)).cwiseProduct(size));
        solid->node_is_rigid.push_back(held && k == 0);
      }
    }
  }
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (int i = 0; i < cells[0]; ++i) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int k = 0; k < cells[2]; ++k) {
        for (std::size_t o = 0; o < kOrders.size(); ++o) {
          std::array<int, 3> at{i, j, k};
          Tetrahedron t{};
          t[0] = node(at[0], at[1], at[2]);
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(kOrders[o][step])];
            t[step + 1] = node(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(t[2], t[3]);
          solid->mesh.tetrahedra.push_back(t);
        }
      }
    }
  }
  solid->mesh.tetrahedron_volume.assign(solid->mesh.tetrahedra.size(), 0);
  solid->mesh.volume_names = {"foam"};
  solid->mesh.surface_names = {"surface"};
  solid->tetrahedron_material.assign(solid->mesh.tetrahedra.size(), 0);
  SoftSolid::Material material;
  material.youngs_modulus = modulus;
  material.poissons_ratio = poissons_ratio;
  material.density = density;
  solid->materials = {material};
  solid->strain_limits = solid->densification();
  std::vector<int> sample_of_node(solid->mesh.nodes.size(), -1);
  const auto faces = faces_of(solid->mesh.tetrahedra);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if ((f > 0 && faces[f - 1].sorted == faces[f].sorted) ||
        (f + 1 < faces.size() && faces[f + 1].sorted == faces[f].sorted)) {
      continue;
    }
    solid->mesh.triangles.push_back(faces[f].outward);
    solid->mesh.triangle_surface.push_back(0);
    Triangle triangle = faces[f].outward;
    for (int& corner : triangle) {
      int& sample = sample_of_node[static_cast<std::size_t>(corner)];
      if (sample < 0) {
        sample = static_cast<int>(solid->sample_nodes.size());
        solid->sample_nodes.push_back(corner);
      }
      corner = sample;
    }
    solid->skin_triangles.push_back(triangle);
  }
  solid->measure();
  return solid;
}

inline VirtualObject soft(const char* name, std::shared_ptr<const SoftSolid> solid,
                          const Vector3& at, double friction = 0.5) {
  VirtualObject object = still(name, HalfSpace{}, at, friction);
  object.soft = std::move(solid);
  return object;
}

}  // namespace softfinger
