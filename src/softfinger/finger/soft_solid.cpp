#include "softfinger/finger/soft_solid.hpp"

namespace softfinger {

double SoftSolid::plane_modulus() const {
  double modulus = 0.0;
  for (const Material& material : materials) {
    const double nu = material.poissons_ratio;
    modulus += material.share * material.youngs_modulus / (1.0 - nu * nu);
  }
  return modulus;
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
    std::array<Vector3, 4> corners;
    bool soft = false;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = static_cast<std::size_t>(mesh.tetrahedra[t][k]);
      corners[k] = mesh.nodes[node];
      soft = soft || !node_is_rigid[node];
    }
    if (!soft) continue;
    const double volume =
        (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]) / 6.0;
    materials[static_cast<std::size_t>(material)].share += volume;
    all += volume;
  }
  for (Material& material : materials) material.share /= all;
}

}  // namespace softfinger
