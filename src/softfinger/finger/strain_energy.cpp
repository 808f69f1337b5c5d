#include "softfinger/finger/strain_energy.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "softfinger/fem/dilatation_patches.hpp"
#include "softfinger/fem/strain_limit.hpp"

namespace softfinger {
namespace {

Matrix3 edges(const std::array<int, 4>& nodes, std::span<const Vector3> positions) {
  Matrix3 columns;
  for (int k = 0; k < 3; ++k) {
    columns.col(k) = positions[static_cast<std::size_t>(nodes[static_cast<std::size_t>(k) + 1])] -
                     positions[static_cast<std::size_t>(nodes[0])];
  }
  return columns;
}

/// Principal stretches; one of them is negative where the element is inside out.
Vector3 principal_stretches(const Matrix3& deformation) {
  const Eigen::JacobiSVD<Matrix3> svd(deformation);
  Vector3 stretches = svd.singularValues();
  if (deformation.determinant() < 0.0) stretches[2] = -stretches[2];
  return stretches;
}

}  // namespace

StrainEnergy::StrainEnergy(std::shared_ptr<const FingerModel> model) : model_(std::move(model)) {
  const TetrahedralMesh& mesh = model_->mesh;
  std::vector<int> material = model_->tetrahedron_material;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const auto& nodes = mesh.tetrahedra[t];
    const bool rigid = std::all_of(nodes.begin(), nodes.end(), [&](int node) {
      return model_->node_is_rigid[static_cast<std::size_t>(node)];
    });
    if (rigid) material[t] = -1;
  }
  std::vector<int> patches(material.size(), -1);
  if (model_->dilatation == Dilatation::kPatch) {
    patches = dilatation_patches(mesh.tetrahedra, material);
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (material[t] < 0) continue;
    const Matrix3 rest = edges(mesh.tetrahedra[t], mesh.nodes);
    elements_.push_back({mesh.tetrahedra[t], material[t], patches[t], rest.inverse()});
    volumes_.push_back(rest.determinant() / 6.0);
    if (patches[t] < 0) continue;
    const auto patch = static_cast<std::size_t>(patches[t]);
    patch_volumes_.resize(std::max(patch_volumes_.size(), patch + 1), 0.0);
    patch_volumes_[patch] += volumes_.back();
  }
}

void StrainEnergy::densities(std::span<const Vector3> positions,
                             std::span<double> densities) const {
  StrainLimit limit;
  if (model_->strain_limits.enabled) {
    const auto& limits = model_->strain_limits;
    limit = {limits.min, limits.max, limits.stiffness, limits.width};
  }
  std::vector<double> dilatations(elements_.size());
  std::vector<double> patch_dilatations(patch_volumes_.size(), 0.0);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    const auto& constants = model_->materials[static_cast<std::size_t>(element.material)];
    const ElasticMaterial material{constants.youngs_modulus, constants.poissons_ratio,
                                   constants.density};
    const Vector3 stretches =
        principal_stretches(edges(element.nodes, positions) * element.rest_inverse);
    const Vector3 strains = stretches.array() - 1.0;
    dilatations[e] = strains.sum();
    if (element.patch >= 0) {
      const auto patch = static_cast<std::size_t>(element.patch);
      patch_dilatations[patch] += dilatations[e] * volumes_[e] / patch_volumes_[patch];
    }
    densities[e] = material.mu() * strains.squaredNorm();
    if (limit.stiffness > 0.0) {
      for (const double stretch : stretches) densities[e] += limit.at(stretch).energy;
    }
  }
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    const auto& constants = model_->materials[static_cast<std::size_t>(element.material)];
    const ElasticMaterial material{constants.youngs_modulus, constants.poissons_ratio,
                                   constants.density};
    const double dilatation = element.patch < 0
                                  ? dilatations[e]
                                  : patch_dilatations[static_cast<std::size_t>(element.patch)];
    densities[e] += 0.5 * material.lambda() * dilatation * dilatation;
  }
}

}  // namespace softfinger
