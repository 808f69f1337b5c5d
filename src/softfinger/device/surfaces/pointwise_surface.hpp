#pragma once

#include <algorithm>
#include <limits>

#include "softfinger/device/contacting_surface.hpp"

namespace softfinger {

/// A surface that knows, placed at one q, how any one point lies to it. `Surface` has
///   Placed placed(const Kinematics& by, const Configuration& q) const
/// and Placed has closest_point_residual(p_F) and signed_distance(p_F); all sums follow.
template <typename Surface>
class PointwiseSurface : public ContactingSurface {
 public:
  [[nodiscard]] ClosestPointResidual closest_point_residual(const Kinematics& by,
                                                            const Configuration& q,
                                                            const Vector3& p_F) const override {
    return self().placed(by, q).closest_point_residual(p_F);
  }
  [[nodiscard]] SurfaceDistance signed_distance(const Kinematics& by, const Configuration& q,
                                                const Vector3& p_F) const override {
    return self().placed(by, q).signed_distance(p_F);
  }

  [[nodiscard]] double deviation(const Kinematics& by, const Configuration& q,
                                 const SurfaceSamples& samples) const override {
    const auto here = self().placed(by, q);
    double sum = 0.0;
    for (int i = 0; i < samples.size(); ++i) {
      const auto s = static_cast<std::size_t>(i);
      const Vector3 p_F(samples.x[s], samples.y[s], samples.z[s]);
      if (i < samples.contact_count) {
        sum += samples.weight[s] * here.closest_point_residual(p_F).residual.squaredNorm();
      } else {
        const double lack = std::min(0.0, here.signed_distance(p_F).distance - samples.margin[s]);
        sum += samples.weight[s] * lack * lack;
      }
    }
    return sum;
  }

  /// Has no second derivative of the surface.
  double deviation_derivatives(const Kinematics& by, const Configuration& q,
                               const SurfaceSamples& samples, Eigen::Ref<Eigen::VectorXd> gradient,
                               Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                               Eigen::Ref<Eigen::MatrixXd> hessian) const override {
    const auto here = self().placed(by, q);
    double sum = 0.0;
    gradient.setZero();
    gauss_newton.setZero();
    for (int i = 0; i < samples.size(); ++i) {
      const auto s = static_cast<std::size_t>(i);
      const Vector3 p_F(samples.x[s], samples.y[s], samples.z[s]);
      const double w = samples.weight[s];
      if (i < samples.contact_count) {
        const ClosestPointResidual nearest = here.closest_point_residual(p_F);
        sum += w * nearest.residual.squaredNorm();
        for (int c = 0; c < 3; ++c) {
          gradient += 2.0 * w * nearest.residual[c] * nearest.jacobian.row(c).transpose();
          add_square(2.0 * w, nearest.jacobian.row(c), gauss_newton);
        }
      } else {
        const SurfaceDistance surface = here.signed_distance(p_F);
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

  [[nodiscard]] double least_distance(const Kinematics& by, const Configuration& q,
                                      const SurfaceSamples& samples) const override {
    const auto here = self().placed(by, q);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < samples.x.size(); ++i) {
      const Vector3 p_F(samples.x[i], samples.y[i], samples.z[i]);
      least = std::min(least, here.signed_distance(p_F).distance);
    }
    return least;
  }

 private:
  [[nodiscard]] const Surface& self() const { return static_cast<const Surface&>(*this); }

  /// matrix += factor row^T row, by columns: an outer product would want a temporary of full
  /// capacity.
  template <typename Row>
  static void add_square(double factor, const Row& row, Eigen::Ref<Eigen::MatrixXd> matrix) {
    for (int k = 0; k < row.size(); ++k) {
      if (row[k] != 0.0) matrix.col(k) += (factor * row[k]) * row.transpose();
    }
  }
};

}  // namespace softfinger
