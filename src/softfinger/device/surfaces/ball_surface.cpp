#include "softfinger/device/surfaces/ball_surface.hpp"

#include <algorithm>

namespace softfinger {
namespace {

constexpr double kAtCentre = 1e-12;  // m

}  // namespace

BallSurface::Placed BallSurface::placed(const Kinematics& by, const Configuration& q) const {
  const RigidMotion motion = by.motion(q);
  Matrix3 rates_B = Matrix3::Zero();
  for (int k = 0; k < motion.count; ++k) {
    rates_B.col(k) = motion.rate[static_cast<std::size_t>(k)].translation;
  }
  return {radius_, by.mount() * motion.X_BP.translation, by.mount().rotation * rates_B,
          motion.count};
}

ClosestPointResidual BallSurface::Placed::closest_point_residual(const Vector3& p_F) const {
  const Vector3 d = p_F - centre_F;
  const double distance = std::max(d.norm(), kAtCentre);
  const Vector3 n = d / distance;
  const double part = 1.0 - radius / distance;
  const Matrix3 by_point = part * Matrix3::Identity() + (1.0 - part) * n * n.transpose();
  ClosestPointResidual answer;
  answer.residual = part * d;
  answer.jacobian = -by_point * rates_F;
  answer.jacobian.conservativeResize(3, count);
  return answer;
}

SurfaceDistance BallSurface::Placed::signed_distance(const Vector3& p_F) const {
  const Vector3 d = p_F - centre_F;
  const double distance = std::max(d.norm(), kAtCentre);
  SurfaceDistance answer{distance - radius, {}};
  answer.gradient = rates_F.transpose() * d / -distance;
  answer.gradient.conservativeResize(count);
  return answer;
}

Pose BallSurface::pose(const Kinematics& by, const Configuration& q) const {
  return by.mount() * (by.pose(q) * Pose{Matrix3::Identity(), Vector3(0.0, 0.0, radius_)});
}

void BallSurface::solid_pieces(const Kinematics& by, const Configuration& q,
                               std::span<SolidPiece> pieces) const {
  pieces[0] = {Ball{radius_}, by.mount() * by.pose(q)};
}

}  // namespace softfinger
