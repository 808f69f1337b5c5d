#include "softfinger/finger/element_loads.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "softfinger/fem/dilatation_patches.hpp"

namespace softfinger {
namespace {

/// An element squeezed to less than this part of its volume bears no more stress for it.
constexpr double kLeastVolume = 0.05;

Matrix3 edges(const std::array<int, 4>& nodes, std::span<const Vector3> positions) {
  Matrix3 columns;
  for (int k = 0; k < 3; ++k) {
    columns.col(k) = positions[static_cast<std::size_t>(nodes[static_cast<std::size_t>(k) + 1])] -
                     positions[static_cast<std::size_t>(nodes[0])];
  }
  return columns;
}

}  // namespace

ElementLoads::ElementLoads(std::shared_ptr<const FingerModel> model) : model_(std::move(model)) {
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
    patches = dilatation_patches(mesh.nodes, mesh.tetrahedra, material);
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (material[t] < 0) continue;
    const ElasticMaterial& elastic = model_->materials[static_cast<std::size_t>(material[t])];
    const Matrix3 rest = edges(mesh.tetrahedra[t], mesh.nodes);
    elements_.push_back(
        {mesh.tetrahedra[t], elastic.lambda(), elastic.mu(), patches[t], rest.inverse()});
    volumes_.push_back(rest.determinant() / 6.0);
    if (patches[t] < 0) continue;
    const auto patch = static_cast<std::size_t>(patches[t]);
    patch_volumes_.resize(std::max(patch_volumes_.size(), patch + 1), 0.0);
    patch_volumes_[patch] += volumes_.back();
  }
  deformations_.resize(elements_.size());
  patch_dilatations_.resize(patch_volumes_.size());
}

void ElementLoads::deform(std::span<const Vector3> positions) {
  std::fill(patch_dilatations_.begin(), patch_dilatations_.end(), 0.0);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    Deformation& deformation = deformations_[e];
    const Matrix3 gradient = edges(element.nodes, positions) * element.rest_inverse;
    const Eigen::SelfAdjointEigenSolver<Matrix3> squares(gradient * gradient.transpose());
    deformation.axes = squares.eigenvectors();
    const Vector3 stretches = squares.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    std::copy_n(stretches.data(), 3, deformation.stretches);
    if (gradient.determinant() < 0.0) deformation.stretches[0] = -deformation.stretches[0];
    deformation.dilatation = Law::dilatation(deformation.stretches);
    if (element.patch < 0) continue;
    const auto patch = static_cast<std::size_t>(element.patch);
    patch_dilatations_[patch] += deformation.dilatation * volumes_[e] / patch_volumes_[patch];
  }
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const int patch = elements_[e].patch;
    if (patch < 0) continue;
    deformations_[e].dilatation = patch_dilatations_[static_cast<std::size_t>(patch)];
  }
}

ElementLoads::Law ElementLoads::law(std::size_t e) const {
  // No pressure: elements of a patch keep their lambda here and have its dilatation.
  return {elements_[e].mu, elements_[e].lambda, deformations_[e].stretches,
          deformations_[e].dilatation, 0.0};
}

void ElementLoads::energy_densities(std::span<const Vector3> positions,
                                    std::span<double> densities) {
  deform(positions);
  const StrainLimit& limit = model_->strain_limits;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    densities[e] = law(e).energy();
    if (!(limit.stiffness > 0.0)) continue;
    for (const double stretch : deformations_[e].stretches) {
      densities[e] += strain_limit_at(limit, stretch).energy;
    }
  }
}

void ElementLoads::stresses(std::span<const Vector3> positions, std::span<Stress> stresses) {
  deform(positions);
  const StrainLimit& limit = model_->strain_limits;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Deformation& deformation = deformations_[e];
    const double(&s)[3] = deformation.stretches;
    // Cauchy's is P F^T / det F; here P has F's axes.
    const double volume = std::max(s[0] * s[1] * s[2], kLeastVolume);
    const Law tissue = law(e);
    Vector3 principal;
    for (int k = 0; k < 3; ++k) {
      const double nominal =
          tissue.stress(k) + (limit.stiffness > 0.0 ? strain_limit_at(limit, s[k]).first : 0.0);
      principal[k] = nominal * s[k] / volume;
    }
    const Matrix3 stress = deformation.axes * principal.asDiagonal() * deformation.axes.transpose();
    stresses[e] = {stress(0, 0), stress(1, 1), stress(2, 2),
                   stress(1, 2), stress(2, 0), stress(0, 1)};
  }
}

}  // namespace softfinger
