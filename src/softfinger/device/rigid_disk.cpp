#include "softfinger/device/rigid_disk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/device/disk_surface.hpp"

namespace softfinger {

ClosestPointResidual RigidDisk::closest_point_residual(const Configuration& q,
                                                       const Vector3& p_F) const {
  const Pose X_FP = surface_pose(q);
  const Matrix3 R_BP = settings().X_FB.rotation.transpose() * X_FP.rotation;
  const Vector3 p_P = X_FP.inverse() * p_F;
  // d(residual)/dp_P: z is free, and beyond the rim the part across goes along outwards and turns.
  Matrix3 by_point = Matrix3::Zero();
  by_point(2, 2) = 1.0;
  const double rho = std::hypot(p_P.x(), p_P.y());
  if (rho > radius_) {
    const Eigen::Vector2d outward(p_P.x() / rho, p_P.y() / rho);
    const double part = 1.0 - radius_ / rho;
    by_point.topLeftCorner<2, 2>() = part * Eigen::Matrix2d::Identity();
    by_point.topLeftCorner<2, 2>() += (1.0 - part) * outward * outward.transpose();
  }
  ClosestPointResidual answer;
  answer.residual = disk_closest_point_residual(radius_, p_P);
  answer.jacobian.resize(3, degrees_of_freedom());
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const PoseRate rate = pose_rate(q, k);
    answer.jacobian.col(k) =
        by_point * (rate.rotation.transpose() * (R_BP * p_P) - R_BP.transpose() * rate.translation);
  }
  return answer;
}

SurfaceDistance RigidDisk::signed_distance(const Configuration& q, const Vector3& p_F) const {
  const Pose X_FP = surface_pose(q);
  const Matrix3 R_BP = settings().X_FB.rotation.transpose() * X_FP.rotation;
  const Vector3 p_P = X_FP.inverse() * p_F;
  const ConeDistance cone = cone_distance(radius_, p_P);
  SurfaceDistance answer{cone.distance, Configuration(degrees_of_freedom())};
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const PoseRate rate = pose_rate(q, k);
    answer.gradient[k] = cone.normal.dot(rate.rotation.transpose() * (R_BP * p_P) -
                                         R_BP.transpose() * rate.translation);
  }
  return answer;
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
