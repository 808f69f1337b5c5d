#pragma once

#include <algorithm>
#include <memory>

#include "box_mesh.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger::testing_support {

/// A block of tissue under a flat bone: 12 x 10 x 6 mm, the top tied to the bone, F's origin 4 mm
/// above the tissue's centre, skin everywhere else.
inline std::shared_ptr<FingerModel> box_finger(int nx = 4, int ny = 3, int nz = 2) {
  auto model = std::make_shared<FingerModel>();
  model->mesh = box_mesh(nx, ny, nz, Vector3(-6, -5, -7) * 1e-3, Vector3(12, 10, 6) * 1e-3);
  const TetrahedralMesh& mesh = model->mesh;
  model->node_is_rigid.assign(mesh.nodes.size(), false);
  model->tetrahedron_material.assign(mesh.tetrahedra.size(), 0);
  model->materials = {{{45e3, 0.4, 1000.0}, "tissue"}};
  model->strain_limits = {0.35, 1.5, 40e3, 0.5};
  std::vector<int> sample_of(mesh.nodes.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int n : mesh.triangles[t]) {
      if (mesh.triangle_surface[t] == 1) model->node_is_rigid[static_cast<std::size_t>(n)] = true;
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.triangle_surface[t] != 0) continue;
    const auto at = [&](std::size_t k) {
      return mesh.nodes[static_cast<std::size_t>(mesh.triangles[t][k])];
    };
    const double third = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 6.0;
    std::array<int, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      int& sample = sample_of[static_cast<std::size_t>(mesh.triangles[t][k])];
      if (sample < 0) {
        sample = static_cast<int>(model->sample_nodes.size());
        model->sample_nodes.push_back(mesh.triangles[t][k]);
        model->sample_rest_areas.push_back(0.0);
      }
      model->sample_rest_areas[static_cast<std::size_t>(sample)] += third;
      triangle[k] = sample;
    }
    model->skin_triangles.push_back(triangle);
  }
  return model;
}

}  // namespace softfinger::testing_support
