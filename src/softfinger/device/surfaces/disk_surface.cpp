#include "softfinger/device/surfaces/disk_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/device/surfaces/disk_geometry.hpp"

namespace softfinger {

Matrix3 DiskSurface::Motion::rates(const Vector3& p_P) const {
  Matrix3 rates = Matrix3::Zero();
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    rates.col(k) = turn[i] * p_P + shift[i];
  }
  return rates;
}

DiskSurface::Motion DiskSurface::in_disk(const Pose& X_FB, const RigidMotion& motion) {
  const Pose X_FP = X_FB * motion.X_BP;
  const Matrix3 R_BP = X_FB.rotation.transpose() * X_FP.rotation;
  Motion here;
  here.X_PF = X_FP.inverse();
  here.count = motion.count;
  for (std::size_t k = 0; k < static_cast<std::size_t>(motion.count); ++k) {
    here.turn[k] = motion.rate[k].rotation.transpose() * R_BP;
    here.shift[k] = -(R_BP.transpose() * motion.rate[k].translation);
  }
  return here;
}

// z is free; beyond the rim the part across goes along outwards, and turns.
Matrix3 DiskSurface::residual_rate(const Vector3& p_P) const {
  Matrix3 rate = Matrix3::Zero();
  rate(2, 2) = 1.0;
  const double rho = std::hypot(p_P.x(), p_P.y());
  if (rho > radius_) {
    const Eigen::Vector2d outward(p_P.x() / rho, p_P.y() / rho);
    const double part = 1.0 - radius_ / rho;
    rate.topLeftCorner<2, 2>() = part * Eigen::Matrix2d::Identity();
    rate.topLeftCorner<2, 2>() += (1.0 - part) * outward * outward.transpose();
  }
  return rate;
}

ClosestPointResidual DiskSurface::closest_point_residual(const Kinematics& by,
                                                         const Configuration& q,
                                                         const Vector3& p_F) const {
  const Motion here = in_disk(by.mount(), by.motion(q));
  const Vector3 p_P = here.X_PF * p_F;
  ClosestPointResidual answer;
  answer.residual = disk_closest_point_residual(radius_, p_P);
  answer.jacobian = (residual_rate(p_P) * here.rates(p_P)).leftCols(here.count);
  return answer;
}

SurfaceDistance DiskSurface::signed_distance(const Kinematics& by, const Configuration& q,
                                             const Vector3& p_F) const {
  const Motion here = in_disk(by.mount(), by.motion(q));
  const Vector3 p_P = here.X_PF * p_F;
  const ConeDistance cone = cone_distance(radius_, p_P);
  return {cone.distance, (here.rates(p_P).transpose() * cone.normal).head(here.count)};
}

double DiskSurface::deviation(const Kinematics& by, const Configuration& q,
                              const SurfaceSamples& samples) const {
  const Pose X_PF = pose(by, q).inverse();
  double sum = 0.0;
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const Vector3 p_P = X_PF * Vector3(samples.x[i], samples.y[i], samples.z[i]);
    if (static_cast<int>(i) < samples.contact_count) {
      sum += samples.weight[i] * disk_closest_point_residual(radius_, p_P).squaredNorm();
    } else {
      const double lack = std::min(0.0, cone_distance(radius_, p_P).distance - samples.margin[i]);
      sum += samples.weight[i] * lack * lack;
    }
  }
  return sum;
}

double DiskSurface::deviation_derivatives(const Kinematics& by, const Configuration& q,
                                          const SurfaceSamples& samples,
                                          Eigen::Ref<Eigen::VectorXd> gradient,
                                          Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                          Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const Motion here = in_disk(by.mount(), by.motion(q));
  double sum = 0.0;
  Vector3 slope = Vector3::Zero();
  Matrix3 square = Matrix3::Zero();
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const Vector3 p_P = here.X_PF * Vector3(samples.x[i], samples.y[i], samples.z[i]);
    const double w2 = 2.0 * samples.weight[i];
    if (static_cast<int>(i) < samples.contact_count) {
      const Vector3 residual = disk_closest_point_residual(radius_, p_P);
      const Matrix3 rate = residual_rate(p_P) * here.rates(p_P);
      sum += 0.5 * w2 * residual.squaredNorm();
      slope += w2 * rate.transpose() * residual;
      square += w2 * rate.transpose() * rate;
    } else {
      const ConeDistance cone = cone_distance(radius_, p_P);
      const double lack = cone.distance - samples.margin[i];
      if (lack >= 0.0) continue;
      const Vector3 rate = here.rates(p_P).transpose() * cone.normal;
      sum += 0.5 * w2 * lack * lack;
      slope += (w2 * lack) * rate;
      square += w2 * rate * rate.transpose();
    }
  }
  gradient = slope.head(here.count);
  gauss_newton = square.topLeftCorner(here.count, here.count);
  hessian = gauss_newton;
  return sum;
}

double DiskSurface::least_distance(const Kinematics& by, const Configuration& q,
                                   const SurfaceSamples& samples) const {
  const Pose X_PF = pose(by, q).inverse();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const Vector3 p_P = X_PF * Vector3(samples.x[i], samples.y[i], samples.z[i]);
    if (p_P.z() >= least) continue;
    least = std::min(least, cone_distance(radius_, p_P).distance);
  }
  return least;
}

void DiskSurface::solid_pieces(const Kinematics& by, const Configuration& q,
                               std::span<SolidPiece> pieces) const {
  pieces[0] = disk_solid(radius_, edge_radius_, pose(by, q));
}

}  // namespace softfinger
