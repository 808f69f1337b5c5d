#include "softfinger/device/surfaces/disk_geometry.hpp"

#include <cmath>
#include <numbers>

namespace softfinger {

Vector3 disk_closest_point_residual(double radius, const Vector3& p_P) {
  const double rho = std::hypot(p_P.x(), p_P.y());
  if (rho <= radius) return {0.0, 0.0, p_P.z()};
  const double beyond = 1.0 - radius / rho;
  return {beyond * p_P.x(), beyond * p_P.y(), p_P.z()};
}

ConeDistance cone_distance(double radius, const Vector3& p_P) {
  constexpr double kHalfSqrt2 = 0.5 * std::numbers::sqrt2;
  const double z = p_P.z();
  const double rho = std::sqrt(p_P.x() * p_P.x() + p_P.y() * p_P.y());
  const double u = rho - radius;  // (u, z): meridian coordinates from the rim
  const double flank = kHalfSqrt2 * (u + z);
  ConeDistance answer;
  const bool above_top = u <= 0.0 && z >= 0.0;
  const bool inside_nearer_top = z <= 0.0 && flank <= 0.0 && z >= flank;
  if (above_top || inside_nearer_top) {
    answer.distance = z;
    return answer;
  }
  // On the axis every direction is as good as another.
  const double safe_rho = rho > 1e-12 ? rho : 1e-12;
  const Vector3 outward =
      rho > 1e-12 ? Vector3(p_P.x() / rho, p_P.y() / rho, 0.0) : Vector3::UnitX();
  answer.tangent = Vector3(-outward.y(), outward.x(), 0.0);
  if (z > u) {  // around the rim; u > 0 here
    answer.distance = std::sqrt(u * u + z * z);
    answer.normal = (u * outward + z * Vector3::UnitZ()) / answer.distance;
    answer.meridian_curvature = 1.0 / answer.distance;
    answer.tangent_curvature = u / (answer.distance * safe_rho);
  } else {
    answer.distance = flank;
    answer.normal = kHalfSqrt2 * (outward + Vector3::UnitZ());
    answer.tangent_curvature = kHalfSqrt2 / safe_rho;
  }
  return answer;
}

SolidPiece disk_solid(double radius, double edge_radius, const Pose& X_FP) {
  constexpr double kHalfThickness = 1e-3;
  return {RoundedCylinder{radius, kHalfThickness, edge_radius},
          X_FP * Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -kHalfThickness)}};
}

}  // namespace softfinger
