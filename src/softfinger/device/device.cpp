#include "softfinger/device/device.hpp"

#include <algorithm>
#include <limits>

namespace softfinger {
namespace {

/// matrix += factor row^T row, by columns: an outer product would want a temporary of full
/// capacity.
template <typename Row>
void add_square(double factor, const Row& row, Eigen::Ref<Eigen::MatrixXd> matrix) {
  for (int k = 0; k < row.size(); ++k) {
    if (row[k] != 0.0) matrix.col(k) += (factor * row[k]) * row.transpose();
  }
}

}  // namespace

double Device::squared_distance(const Configuration& a, const Configuration& b) const {
  double sum = 0.0;
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const double d = settings_.axes[static_cast<std::size_t>(k)].metric * (a[k] - b[k]);
    sum += d * d;
  }
  return sum;
}

bool Device::within_axes(const Configuration& q) const {
  constexpr double kTolerance = 1e-9;
  if (q.size() != degrees_of_freedom() || !q.allFinite()) return false;
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const ConfigurationAxis& axis = settings_.axes[static_cast<std::size_t>(k)];
    if (q[k] < axis.min - kTolerance || q[k] > axis.max + kTolerance) return false;
  }
  return true;
}

void Device::advance(double distance, Configuration& q) const {
  const int axis = approach_axis();
  if (axis >= 0) q[axis] += distance / settings_.axes[static_cast<std::size_t>(axis)].metric;
}

double Device::deviation(const Configuration& q, const SurfaceSamples& samples) const {
  double sum = 0.0;
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_F(samples.x[s], samples.y[s], samples.z[s]);
    if (i < samples.contact_count) {
      sum += samples.weight[s] * closest_point_residual(q, p_F).residual.squaredNorm();
    } else {
      const double lack = std::min(0.0, signed_distance(q, p_F).distance - samples.margin[s]);
      sum += samples.weight[s] * lack * lack;
    }
  }
  return sum;
}

double Device::deviation_derivatives(const Configuration& q, const SurfaceSamples& samples,
                                     Eigen::Ref<Eigen::VectorXd> gradient,
                                     Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                     Eigen::Ref<Eigen::MatrixXd> hessian) const {
  double sum = 0.0;
  gradient.setZero();
  gauss_newton.setZero();
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_F(samples.x[s], samples.y[s], samples.z[s]);
    const double w = samples.weight[s];
    if (i < samples.contact_count) {
      const ClosestPointResidual nearest = closest_point_residual(q, p_F);
      sum += w * nearest.residual.squaredNorm();
      for (int c = 0; c < 3; ++c) {
        gradient += 2.0 * w * nearest.residual[c] * nearest.jacobian.row(c).transpose();
        add_square(2.0 * w, nearest.jacobian.row(c), gauss_newton);
      }
    } else {
      const SurfaceDistance surface = signed_distance(q, p_F);
      const double lack = surface.distance - samples.margin[s];
      if (lack >= 0.0) continue;
      sum += w * lack * lack;
      gradient += 2.0 * w * lack * surface.gradient;
      add_square(2.0 * w, surface.gradient.transpose(), gauss_newton);
    }
  }
  hessian = gauss_newton;
  return sum;
}

double Device::least_distance(const Configuration& q, const SurfaceSamples& samples) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const Vector3 p_F(samples.x[i], samples.y[i], samples.z[i]);
    least = std::min(least, signed_distance(q, p_F).distance);
  }
  return least;
}

WorkspaceOutline Device::workspace_outline() const {
  WorkspaceOutline outline;
  outline.reaches = workspace_summary().reaches;
  return outline;
}

void Device::linkage(const Configuration& /*q*/, std::span<Vector3> /*points_F*/) const {}

}  // namespace softfinger
