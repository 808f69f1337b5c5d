#include "softfinger/objectives/stress_match.hpp"

#include <cmath>

namespace softfinger {
namespace {

constexpr double kDifference = 1e-7;  // m of surface motion, of differences of stress

double step_of(const Twin& twin, int k) {
  return kDifference / twin.device().axes()[static_cast<std::size_t>(k)].metric;
}

}  // namespace

StressMatch::StressMatch(const std::shared_ptr<const FingerModel>& model, double weight, int dof)
    : loads_(model),
      wanted_(loads_.size()),
      stresses_(loads_.size()),
      scales_(static_cast<Eigen::Index>(6 * loads_.size())),
      residual_(scales_.size()),
      jacobian_(scales_.size(), dof),
      moved_(model->mesh.nodes.size()) {
  double sum = 0.0;
  for (const double volume : loads_.volumes()) sum += volume;
  for (std::size_t e = 0; e < loads_.size(); ++e) {
    const double one = weight * std::sqrt(loads_.volumes()[e] / sum);
    // Shear stands twice in the tensor.
    for (Eigen::Index c = 0; c < 6; ++c) {
      scales_[6 * static_cast<Eigen::Index>(e) + c] = c < 3 ? one : std::sqrt(2.0) * one;
    }
  }
}

void StressMatch::want(std::span<const Vector3> nodes_F) { loads_.stresses(nodes_F, wanted_); }

double StressMatch::cost(const Twin& twin) {
  evaluate(twin.positions());
  return residual_.squaredNorm();
}

void StressMatch::linearise(const Twin& twin) {
  const std::span<const Vector3> positions = twin.positions();
  for (int k = 0; k < jacobian_.cols(); ++k) {
    const double step = step_of(twin, k);
    for (std::size_t n = 0; n < moved_.size(); ++n) {
      moved_[n] = positions[n] + step * twin.node_motion(n, k);
    }
    evaluate(moved_);
    jacobian_.col(k) = residual_ / step;
  }
  evaluate(positions);
  for (int k = 0; k < jacobian_.cols(); ++k) jacobian_.col(k) -= residual_ / step_of(twin, k);
}

void StressMatch::add_to(Eigen::VectorXd& gradient, Eigen::MatrixXd& gauss_newton) const {
  // By columns: a matrix product wants memory.
  for (int j = 0; j < jacobian_.cols(); ++j) {
    gradient[j] += 2.0 * jacobian_.col(j).dot(residual_);
    for (int i = 0; i < jacobian_.cols(); ++i) {
      gauss_newton(i, j) += 2.0 * jacobian_.col(i).dot(jacobian_.col(j));
    }
  }
}

void StressMatch::evaluate(std::span<const Vector3> positions) {
  loads_.stresses(positions, stresses_);
  for (std::size_t e = 0; e < stresses_.size(); ++e) {
    for (std::size_t c = 0; c < 6; ++c) {
      const auto i = static_cast<Eigen::Index>(6 * e + c);
      residual_[i] = scales_[i] * (stresses_[e][c] - wanted_[e][c]);
    }
  }
}

}  // namespace softfinger
