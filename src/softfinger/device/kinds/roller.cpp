#include "softfinger/device/kinds/roller.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kOnAxis = 1e-12;  // m

}  // namespace

Roller::Roller(DeviceSettings settings, const RollerGeometry& geometry)
    : LinearDrives(std::move(settings)),
      geometry_(geometry),
      X_BF_(this->settings().X_FB.inverse()) {}

std::vector<ConfigurationAxis> Roller::axes_for(const RollerGeometry& geometry) {
  return {{"position_mm", mm, 1.0, geometry.min_position, geometry.max_position},
          {"height_mm", mm, 1.0, geometry.min_height, geometry.max_height}};
}

Vector3 Roller::from_axis(const Configuration& q, const Vector3& p_F) const {
  return X_BF_ * p_F - Vector3(q[0], 0.0, q[1] - geometry_.roller_radius);
}

ClosestPointResidual Roller::closest_point_residual(const Configuration& q,
                                                    const Vector3& p_F) const {
  const Vector3 d = from_axis(q, p_F);
  const double half = 0.5 * geometry_.roller_length;
  const double rho = std::max(std::hypot(d.x(), d.z()), kOnAxis);
  const double nx = d.x() / rho;
  const double nz = d.z() / rho;
  const double part = 1.0 - geometry_.roller_radius / rho;
  ClosestPointResidual answer;
  answer.residual = {part * d.x(), d.y() - std::clamp(d.y(), -half, half), part * d.z()};
  // d(residual)/dd = n n^T + part (1 - n n^T) in the plane; d moves against q.
  const double cross = (1.0 - part) * nx * nz;
  answer.jacobian.resize(3, 2);
  answer.jacobian.col(0) = -Vector3(part + (1.0 - part) * nx * nx, 0.0, cross);
  answer.jacobian.col(1) = -Vector3(cross, 0.0, part + (1.0 - part) * nz * nz);
  return answer;
}

SurfaceDistance Roller::signed_distance(const Configuration& q, const Vector3& p_F) const {
  const Vector3 d = from_axis(q, p_F);
  const double rho = std::max(std::hypot(d.x(), d.z()), kOnAxis);
  const double around = rho - geometry_.roller_radius;
  const double aside = std::abs(d.y()) - 0.5 * geometry_.roller_length;
  SurfaceDistance answer{0.0, Configuration::Zero(2)};
  double by_around = 1.0;
  if (aside <= 0.0 || around <= 0.0) {
    answer.distance = std::max(around, aside);
    by_around = around >= aside ? 1.0 : 0.0;
  } else {
    answer.distance = std::hypot(around, aside);
    by_around = around / answer.distance;
  }
  answer.gradient[0] = -by_around * d.x() / rho;
  answer.gradient[1] = -by_around * d.z() / rho;
  return answer;
}

Pose Roller::surface_pose(const Configuration& q) const {
  return settings().X_FB * Pose{Matrix3::Identity(), Vector3(q[0], 0.0, q[1])};
}

void Roller::solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const {
  // A cylinder lies along z of its own frame: turned about x so that z is across the finger.
  Matrix3 across;
  across << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0;
  pieces[0] = {RoundedCylinder{geometry_.roller_radius, 0.5 * geometry_.roller_length,
                               geometry_.roller_edge_radius},
               settings().X_FB * Pose{across, Vector3(q[0], 0.0, q[1] - geometry_.roller_radius)}};
}

}  // namespace softfinger
