#pragma once

#include "softfinger/device/contacting_surface.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

// The contacting disk {z = 0, rho <= radius} of a platform in the platform's frame P, z towards the
// finger, and the solid {z <= 0, rho <= radius - z}: the disk extended away from the finger as a
// truncated cone with a 45-degree flank. Perez, Lobo, Chinello, Cirio, Malvezzi, San Martin,
// Prattichizzo, Otaduy, "Soft finger tactile rendering for wearable haptics", World Haptics 2015.

/// From the nearest point of the disk to p_P, m; squared norm = dist^2.
[[nodiscard]] Vector3 disk_closest_point_residual(double radius, const Vector3& p_P);

/// Signed distance to the solid with its curvature: hessian = tangent_curvature t t^T +
/// meridian_curvature m m^T, t = z x e_rho / |..| around the axis, m = t x normal.
struct ConeDistance {
  double distance = 0.0;  ///< m, positive outside
  Vector3 normal = Vector3::UnitZ();
  Vector3 tangent = Vector3::UnitY();
  double tangent_curvature = 0.0;   ///< 1/m
  double meridian_curvature = 0.0;  ///< 1/m; not zero only around the rim
};
[[nodiscard]] ConeDistance cone_distance(double radius, const Vector3& p_P);

/// The disk as the solid that presses a finger: the cylinder {-2 mm <= z <= 0, rho <= radius}, its
/// rims rounded by edge_radius (m). Frames: X_FP of the disk.
[[nodiscard]] SolidPiece disk_solid(double radius, double edge_radius, const Pose& X_FP);

}  // namespace softfinger
