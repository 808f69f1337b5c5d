#include "plain_elasticity.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;

Matrix9 positive_semidefinite(const Matrix9& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix9> solver(matrix);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
         solver.eigenvectors().transpose();
}

}  // namespace

PlainElasticity::PlainElasticity(const FingerModel& model)
    : masses_(model.mesh.nodes.size(), 0.0), limit_(model.strain_limits) {
  if (model.dilatation != Dilatation::kElement || !model.relaxation.terms.empty()) {
    throw InputError("the plain step knows neither patches nor relaxation");
  }
  for (std::size_t t = 0; t < model.mesh.tetrahedra.size(); ++t) {
    if (model.tetrahedron_material[t] < 0) continue;
    const auto& m = model.materials[static_cast<std::size_t>(model.tetrahedron_material[t])];
    const auto& nodes = model.mesh.tetrahedra[t];
    const auto rest = [&](std::size_t a) -> const Vector3& {
      return model.mesh.nodes[static_cast<std::size_t>(nodes[a])];
    };
    Matrix3 edges;
    edges << rest(1) - rest(0), rest(2) - rest(0), rest(3) - rest(0);
    const double volume = edges.determinant() / 6.0;
    bool deforms = false;
    for (const int node : nodes) {
      masses_[static_cast<std::size_t>(node)] += 0.25 * m.density * volume;
      deforms = deforms || !model.node_is_rigid[static_cast<std::size_t>(node)];
    }
    if (!deforms) continue;
    const double nu = m.poissons_ratio;
    Element element{
        {nodes[0], nodes[1], nodes[2], nodes[3]},
        {},
        volume,
        m.youngs_modulus / (2.0 * (1.0 + nu)),
        m.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
    };
    element.shape_gradients.rightCols<3>() = edges.inverse().transpose();
    element.shape_gradients.col(0) = -element.shape_gradients.rightCols<3>().rowwise().sum();
    elements_.push_back(element);
  }
}

PlainElasticity::Deformation PlainElasticity::deform(const Element& element,
                                                     std::span<const Vector3> positions) const {
  Matrix3 F = Matrix3::Zero();
  for (int a = 0; a < 4; ++a) {
    F += positions[static_cast<std::size_t>(element.nodes[static_cast<std::size_t>(a)])] *
         element.shape_gradients.col(a).transpose();
  }
  const Eigen::JacobiSVD<Matrix3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Deformation d{svd.matrixU(), svd.matrixV(), svd.singularValues(), {}, {}, 0.0};
  // Reflections go to the sign of the smallest stretch.
  for (Matrix3* side : {&d.U, &d.V}) {
    if (side->determinant() > 0.0) continue;
    side->col(2) *= -1.0;
    d.stretches[2] *= -1.0;
  }
  const double dilatation = d.stretches.sum() - 3.0;
  d.energy_density = 0.5 * element.lambda * dilatation * dilatation;
  for (int i = 0; i < 3; ++i) {
    const double strain = d.stretches[i] - 1.0;
    const StrainLimitResponse<double> limit = strain_limit_at(limit_, d.stretches[i]);
    d.energy_density += element.mu * strain * strain + limit.energy;
    d.stresses[i] = 2.0 * element.mu * strain + element.lambda * dilatation + limit.first;
    d.curvatures[i] = 2.0 * element.mu + limit.second;
  }
  return d;
}

double PlainElasticity::energy_gradient(std::span<const Vector3> positions,
                                        std::span<Vector3> gradient) const {
  double energy = 0.0;
  for (const Element& element : elements_) {
    const Deformation d = deform(element, positions);
    energy += element.volume * d.energy_density;
    const Matrix3 stress = element.volume * d.U * d.stresses.asDiagonal() * d.V.transpose();
    for (int a = 0; a < 4; ++a) {
      gradient[static_cast<std::size_t>(element.nodes[static_cast<std::size_t>(a)])] +=
          stress * element.shape_gradients.col(a);
    }
  }
  return energy;
}

PlainElasticity::ElementHessian PlainElasticity::hessian(std::size_t e,
                                                         std::span<const Vector3> positions) const {
  const Element& element = elements_[e];
  const Deformation d = deform(element, positions);
  // By F, in the basis in which stretches and the rotations of pairs of axes part: column k of
  // `modes` is U E_k V^T (Stomakhin et al., "Energetically consistent invertible elasticity", SCA
  // 2012).
  Matrix9 modes, stiffness = Matrix9::Zero();
  int k = 0;
  const auto add_mode = [&](const Matrix3& mode) {
    const Matrix3 turned = d.U * mode * d.V.transpose();
    modes.col(k++) = turned.reshaped();
  };
  for (int i = 0; i < 3; ++i) {
    add_mode(Vector3::Unit(i) * Vector3::Unit(i).transpose());
    stiffness(i, i) = d.curvatures[i];
    for (int j = 0; j < 3; ++j) stiffness(i, j) += element.lambda;
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    Matrix3 mode = Matrix3::Zero();
    mode(i, j) = mode(j, i) = 1.0 / std::numbers::sqrt2;
    const double apart = d.stretches[i] - d.stretches[j];
    stiffness(k, k) = std::abs(apart) > 1e-6 ? (d.stresses[i] - d.stresses[j]) / apart
                                             : 0.5 * (d.curvatures[i] + d.curvatures[j]);
    add_mode(mode);
    mode(i, j) *= -1.0;
    stiffness(k, k) =
        (d.stresses[i] + d.stresses[j]) / std::max(d.stretches[i] + d.stretches[j], 1e-3);
    add_mode(mode);
  }
  const Matrix9 by_F = positive_semidefinite(modes * stiffness * modes.transpose());
  Eigen::Matrix<double, 9, 12> F_by_nodes = Eigen::Matrix<double, 9, 12>::Zero();
  for (int a = 0; a < 4; ++a) {
    for (int j = 0; j < 3; ++j) {
      F_by_nodes.block<3, 3>(3 * j, 3 * a).diagonal().setConstant(element.shape_gradients(j, a));
    }
  }
  return element.volume * F_by_nodes.transpose() * by_F * F_by_nodes;
}

}  // namespace softfinger
