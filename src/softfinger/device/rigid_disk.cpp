#include "softfinger/device/rigid_disk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/device/disk_surface.hpp"

namespace softfinger {

Matrix3 RigidDisk::Motion::rates(const Vector3& p_P) const {
  Matrix3 rates = Matrix3::Zero();
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    rates.col(k) = turn[i] * p_P + shift[i];
  }
  return rates;
}

RigidDisk::Motion RigidDisk::motion(const Configuration& q) const {
  const Pose X_FP = surface_pose(q);
  const Matrix3 R_BP = settings().X_FB.rotation.transpose() * X_FP.rotation;
  Motion motion;
  motion.X_PF = X_FP.inverse();
  motion.count = degrees_of_freedom();
  for (int k = 0; k < motion.count; ++k) {
    const PoseRate rate = pose_rate(q, k);
    motion.turn[static_cast<std::size_t>(k)] = rate.rotation.transpose() * R_BP;
    motion.shift[static_cast<std::size_t>(k)] = -(R_BP.transpose() * rate.translation);
  }
  return motion;
}

// z is free; beyond the rim the part across goes along outwards, and turns.
Matrix3 RigidDisk::residual_rate(const Vector3& p_P) const {
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

ClosestPointResidual RigidDisk::closest_point_residual(const Configuration& q,
                                                       const Vector3& p_F) const {
  const Motion here = motion(q);
  const Vector3 p_P = here.X_PF * p_F;
  ClosestPointResidual answer;
  answer.residual = disk_closest_point_residual(radius_, p_P);
  answer.jacobian = (residual_rate(p_P) * here.rates(p_P)).leftCols(here.count);
  return answer;
}

SurfaceDistance RigidDisk::signed_distance(const Configuration& q, const Vector3& p_F) const {
  const Motion here = motion(q);
  const Vector3 p_P = here.X_PF * p_F;
  const ConeDistance cone = cone_distance(radius_, p_P);
  return {cone.distance, (here.rates(p_P).transpose() * cone.normal).head(here.count)};
}

double RigidDisk::deviation(const Configuration& q, const SurfaceSamples& samples) const {
  const Pose X_PF = surface_pose(q).inverse();
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

double RigidDisk::deviation_derivatives(const Configuration& q, const SurfaceSamples& samples,
                                        Eigen::Ref<Eigen::VectorXd> gradient,
                                        Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                        Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const Motion here = motion(q);
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

double RigidDisk::least_distance(const Configuration& q, const SurfaceSamples& samples) const {
  const Pose X_PF = surface_pose(q).inverse();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const Vector3 p_P = X_PF * Vector3(samples.x[i], samples.y[i], samples.z[i]);
    if (p_P.z() >= least) continue;
    least = std::min(least, cone_distance(radius_, p_P).distance);
  }
  return least;
}

void RigidDisk::solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const {
  pieces[0] = disk_solid(radius_, edge_radius_, surface_pose(q));
}

}  // namespace softfinger
