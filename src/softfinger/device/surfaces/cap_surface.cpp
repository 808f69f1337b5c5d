#include "softfinger/device/surfaces/cap_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softfinger {
namespace {

constexpr double kHalfPlate = 1e-3;    // m
constexpr double kLeastHeight = 1e-5;  // m; a flatter cap is hidden in the plate

/// From the nearest point of the cap to a point in its meridian plane, m, with derivatives by the
/// cap's height.
struct CapResidual {
  double across = 0.0, along = 0.0;  ///< away from the axis, along z
  double across_h = 0.0, along_h = 0.0;
  bool on_cap = true;     ///< not on its rim
  double distance = 0.0;  ///< to the cap's ball, positive outside
  double distance_h = 0.0;
};

/// Curvature k = 2 h / (r^2 + h^2); with s = z - h and w = 2 s + k (s^2 + rho^2) the distance to
/// the ball is w / (1 + sqrt(1 + k w)) and its normal (k rho, k s + 1) / sqrt(1 + k w).
CapResidual cap_residual(double ring, double h, double rho, double z) {
  const double square = ring * ring + h * h;
  const double k = 2.0 * h / square;
  const double k_h = 2.0 * (ring * ring - h * h) / (square * square);
  const double s = z - h;
  const double far = s * s + rho * rho;
  const double w = 2.0 * s + k * far;
  const double root = std::sqrt(std::max(1e-12, 1.0 + k * w));  // of |p - centre| / radius
  const double w_h = -2.0 - 2.0 * k * s + k_h * far;
  const double root_h = (k_h * w + k * w_h) / (2.0 * root);
  CapResidual answer;
  answer.distance = w / (1.0 + root);
  answer.distance_h = w_h / (1.0 + root) - w * root_h / ((1.0 + root) * (1.0 + root));
  const double n_across = k * rho / root;
  const double n_along = (k * s + 1.0) / root;
  // At the rim the normal's part across is k r.
  answer.on_cap = rho <= ring * root && k * s + 1.0 > 0.0;
  if (!answer.on_cap) {
    answer.across = rho - ring;
    answer.along = z;
    return answer;
  }
  const double n_across_h = k_h * rho / root - n_across * root_h / root;
  const double n_along_h = (k_h * s - k) / root - n_along * root_h / root;
  answer.across = answer.distance * n_across;
  answer.along = answer.distance * n_along;
  answer.across_h = answer.distance_h * n_across + answer.distance * n_across_h;
  answer.along_h = answer.distance_h * n_along + answer.distance * n_along_h;
  return answer;
}

}  // namespace

ClosestPointResidual CapSurface::Placed::closest_point_residual(const Vector3& p_F) const {
  const Vector3 p_B = X_BF * p_F;
  const double rho = std::hypot(p_B.x(), p_B.y());
  const CapResidual cap = cap_residual(ring_radius, height, rho, p_B.z());
  const Vector3 outward =
      rho > 1e-12 ? Vector3(p_B.x() / rho, p_B.y() / rho, 0.0) : Vector3::UnitX();
  ClosestPointResidual answer;
  answer.residual = cap.across * outward + cap.along * Vector3::UnitZ();
  answer.jacobian = cap.across_h * outward + cap.along_h * Vector3::UnitZ();
  return answer;
}

SurfaceDistance CapSurface::Placed::signed_distance(const Vector3& p_F) const {
  const Vector3 p_B = X_BF * p_F;
  const double rho = std::hypot(p_B.x(), p_B.y());
  const double z = p_B.z();
  const double ring = ring_radius;
  const CapResidual cap = cap_residual(ring, height, rho, z);
  const double flank = 0.5 * std::numbers::sqrt2 * (rho - ring + z);
  const bool inside = z >= 0.0 ? cap.distance <= 0.0 && rho <= ring : flank <= 0.0;
  const double rim = std::hypot(rho - ring, z);
  // The flank's foot lies on it where the point is not ahead of the rim.
  const double aside = rho - ring > z ? std::abs(flank) : rim;
  const double to_cap = cap.on_cap ? std::abs(cap.distance) : rim;
  const double sign = inside ? -1.0 : 1.0;
  SurfaceDistance answer{sign * std::min(to_cap, aside), Configuration::Zero(1)};
  if (cap.on_cap && to_cap <= aside) answer.gradient[0] = cap.distance_h;
  return answer;
}

Pose CapSurface::pose(const Kinematics& by, const Configuration& q) const {
  return by.mount() * Pose{Matrix3::Identity(), Vector3(0.0, 0.0, q[0])};
}

void CapSurface::solid_pieces(const Kinematics& by, const Configuration& q,
                              std::span<SolidPiece> pieces) const {
  const double h = std::max(q[0], kLeastHeight);
  const double ring = geometry_.ring_radius;
  const double radius = (ring * ring + h * h) / (2.0 * h);
  pieces[0] = {Ball{radius}, by.mount() * Pose{Matrix3::Identity(), {0.0, 0.0, h - radius}}};
  pieces[1] = {RoundedCylinder{ring + geometry_.rim_width, kHalfPlate, geometry_.rim_edge_radius},
               by.mount() * Pose{Matrix3::Identity(), {0.0, 0.0, -kHalfPlate}}};
}

}  // namespace softfinger
