#include "softfinger/finger/soft_solid.hpp"

#include <algorithm>

namespace softfinger {
namespace {

double volume_of(const TetrahedralMesh& mesh, std::size_t tetrahedron) {
  std::array<Vector3, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) {
    corners[k] = mesh.nodes[static_cast<std::size_t>(mesh.tetrahedra[tetrahedron][k])];
  }
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]) /
         6.0;
}

}  // namespace

double SoftSolid::mass() const {
  double mass = 0.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (tetrahedron_material[t] < 0) continue;
    mass +=
        materials[static_cast<std::size_t>(tetrahedron_material[t])].density * volume_of(mesh, t);
  }
  return mass;
}

double SoftSolid::plane_modulus() const {
  double modulus = 0.0;
  for (const Material& material : materials) {
    const double nu = material.poissons_ratio;
    modulus += material.share * material.youngs_modulus / (1.0 - nu * nu);
  }
  return modulus;
}

StrainLimit SoftSolid::densification() const {
  const auto softest = std::ranges::min_element(materials, {}, &Material::youngs_modulus);
  return {.min = 0.1, .max = 10.0, .stiffness = softest->youngs_modulus, .width = 0.2};
}

bool SoftSolid::is_held() const {
  return std::ranges::find(node_is_rigid, true) != node_is_rigid.end();
}

void SoftSolid::measure() {
  sample_rest_areas.assign(sample_nodes.size(), 0.0);
  for (const auto& triangle : skin_triangles) {
    std::array<Vector3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const int node = sample_nodes[static_cast<std::size_t>(triangle[k])];
      corners[k] = mesh.nodes[static_cast<std::size_t>(node)];
    }
    const double area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
    for (const int sample : triangle) {
      sample_rest_areas[static_cast<std::size_t>(sample)] += area / 3.0;
    }
  }
  // Tetrahedra that move with the bone as a whole are none of the tissue.
  double all = 0.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const int material = tetrahedron_material[t];
    if (material < 0) continue;
    const bool soft = std::ranges::any_of(mesh.tetrahedra[t], [&](int node) {
      return !node_is_rigid[static_cast<std::size_t>(node)];
    });
    if (!soft) continue;
    const double volume = volume_of(mesh, t);
    materials[static_cast<std::size_t>(material)].share += volume;
    all += volume;
  }
  for (Material& material : materials) material.share /= all;
}

}  // namespace softfinger
