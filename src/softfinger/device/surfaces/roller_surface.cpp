#include "softfinger/device/surfaces/roller_surface.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

constexpr double kOnAxis = 1e-12;  // m

}  // namespace

RollerSurface::Placed RollerSurface::placed(const Kinematics& by, const Configuration& q) const {
  const RigidMotion motion = by.motion(q);
  return {by.mount().inverse(), motion, motion.X_BP * middle(), geometry_.roller_radius,
          0.5 * geometry_.roller_length};
}

Vector3 RollerSurface::Placed::from_axis(const Vector3& p_B) const {
  return motion.X_BP.rotation.transpose() * (p_B - middle_B);
}

Vector3 RollerSurface::Placed::rate(std::size_t k, const Vector3& p_B) const {
  const PoseRate& by_k = motion.rate[k];
  return by_k.rotation.transpose() * (p_B - motion.X_BP.translation) -
         motion.X_BP.rotation.transpose() * by_k.translation;
}

ClosestPointResidual RollerSurface::Placed::closest_point_residual(const Vector3& p_F) const {
  const Vector3 p_B = X_BF * p_F;
  const Vector3 d = from_axis(p_B);
  const double rho = std::max(std::hypot(d.x(), d.z()), kOnAxis);
  const double nx = d.x() / rho;
  const double nz = d.z() / rho;
  const double part = 1.0 - radius / rho;
  const double beside = d.y() - std::clamp(d.y(), -half_length, half_length);
  ClosestPointResidual answer;
  answer.residual = {part * d.x(), beside, part * d.z()};
  // d(residual)/dd = n n^T + part (1 - n n^T) in the plane.
  const double cross = (1.0 - part) * nx * nz;
  Matrix3 by_point;
  by_point << part + (1.0 - part) * nx * nx, 0.0, cross,  //
      0.0, beside == 0.0 ? 0.0 : 1.0, 0.0,                //
      cross, 0.0, part + (1.0 - part) * nz * nz;
  answer.jacobian.resize(3, motion.count);
  for (int k = 0; k < motion.count; ++k) {
    answer.jacobian.col(k) = by_point * rate(static_cast<std::size_t>(k), p_B);
  }
  return answer;
}

SurfaceDistance RollerSurface::Placed::signed_distance(const Vector3& p_F) const {
  const Vector3 p_B = X_BF * p_F;
  const Vector3 d = from_axis(p_B);
  const double rho = std::max(std::hypot(d.x(), d.z()), kOnAxis);
  const double around = rho - radius;
  const double aside = std::abs(d.y()) - half_length;
  SurfaceDistance answer{0.0, Configuration::Zero(motion.count)};
  double by_around = 1.0;
  double by_aside = 0.0;
  if (aside <= 0.0 || around <= 0.0) {
    answer.distance = std::max(around, aside);
    by_around = around >= aside ? 1.0 : 0.0;
    by_aside = 1.0 - by_around;
  } else {
    answer.distance = std::hypot(around, aside);
    by_around = around / answer.distance;
    by_aside = aside / answer.distance;
  }
  const Vector3 by_point(by_around * d.x() / rho, std::copysign(by_aside, d.y()),
                         by_around * d.z() / rho);
  for (int k = 0; k < motion.count; ++k) {
    answer.gradient[k] = by_point.dot(rate(static_cast<std::size_t>(k), p_B));
  }
  return answer;
}

void RollerSurface::solid_pieces(const Kinematics& by, const Configuration& q,
                                 std::span<SolidPiece> pieces) const {
  // A cylinder lies along z of its own frame: turned about x so that z is across the finger.
  Matrix3 across;
  across << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0;
  pieces[0] = {RoundedCylinder{geometry_.roller_radius, 0.5 * geometry_.roller_length,
                               geometry_.roller_edge_radius},
               by.mount() * (by.pose(q) * Pose{across, middle()})};
}

}  // namespace softfinger
