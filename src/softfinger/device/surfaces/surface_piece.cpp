#include "softfinger/device/surfaces/surface_piece.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/device/surfaces/disk_geometry.hpp"
#include "softfinger/geometry/signed_distance_grid.hpp"

namespace softfinger {
namespace {

constexpr double kPinHalfLength = 5e-3;  // m; of the solid of a pin
constexpr double kPinEdge = 0.1e-3;      // m

/// A point by the axis of a disk or pin: how far out, and in which direction.
struct Around {
  explicit Around(const Vector3& p_S) : rho(std::hypot(p_S.x(), p_S.y())) {
    // On the axis every direction is as good as another.
    if (rho > 1e-12) outward = Vector3(p_S.x() / rho, p_S.y() / rho, 0.0);
    tangent = Vector3(-outward.y(), outward.x(), 0.0);
  }
  double rho;
  Vector3 outward = Vector3::UnitX(), tangent;
};

NearestPoint nearest_of_disk(double radius, const Vector3& p_S) {
  const Around around(p_S);
  NearestPoint nearest;
  nearest.residual = disk_closest_point_residual(radius, p_S);
  nearest.gradient = nearest.residual;
  nearest.squared_distance = nearest.residual.squaredNorm();
  nearest.derivative = Vector3::UnitZ() * Vector3::UnitZ().transpose();
  if (around.rho > radius) {
    nearest.derivative += around.outward * around.outward.transpose() +
                          (1.0 - radius / around.rho) * around.tangent * around.tangent.transpose();
  }
  return nearest;
}

SignedDistance distance_of_disk(double radius, const Vector3& p_S) {
  const ConeDistance cone = cone_distance(radius, p_S);
  const Vector3 meridian = cone.tangent.cross(cone.normal);
  return {cone.distance, cone.normal,
          cone.tangent_curvature * cone.tangent * cone.tangent.transpose() +
              cone.meridian_curvature * meridian * meridian.transpose()};
}

SignedDistance distance_of_pin(double radius, const Vector3& p_S) {
  const Around around(p_S);
  const double u = around.rho - radius;
  const double z = p_S.z();
  const Matrix3 around_axis = around.tangent * around.tangent.transpose();
  if (u > 0.0 && z > 0.0) {  // around the rim
    const double distance = std::hypot(u, z);
    const Vector3 normal = (u * around.outward + z * Vector3::UnitZ()) / distance;
    const Vector3 meridian = around.tangent.cross(normal);
    return {distance, normal,
            (u / around.rho * around_axis + meridian * meridian.transpose()) / distance};
  }
  if (z > u) return {z, Vector3::UnitZ(), Matrix3::Zero()};
  return {u, around.outward, around_axis / std::max(around.rho, 1e-12)};
}

}  // namespace

NearestPoint nearest_point(const PieceShape& shape, const Vector3& p_S) {
  if (const auto* disk = std::get_if<DiskPiece>(&shape)) return nearest_of_disk(disk->radius, p_S);
  if (const auto* pin = std::get_if<PinPiece>(&shape)) return nearest_of_disk(pin->radius, p_S);
  const SignedDistance surface = signed_distance(*std::get_if<Shape>(&shape), p_S);
  const double length = surface.gradient.norm();
  NearestPoint nearest;
  nearest.squared_distance = surface.distance * surface.distance;
  nearest.gradient = surface.distance * surface.gradient;
  // A mesh's gradient is shorter than 1 where an edge is rounded.
  if (length > 0.0) nearest.residual = nearest.gradient / length;
  nearest.derivative =
      surface.gradient * surface.gradient.transpose() + surface.distance * surface.hessian;
  return nearest;
}

double squared_face_distance(const PieceShape& shape, const Vector3& p_S) {
  if (const auto* disk = std::get_if<DiskPiece>(&shape)) {
    return disk_closest_point_residual(disk->radius, p_S).squaredNorm();
  }
  if (const auto* pin = std::get_if<PinPiece>(&shape)) {
    return disk_closest_point_residual(pin->radius, p_S).squaredNorm();
  }
  const double distance = distance_and_gradient(*std::get_if<Shape>(&shape), p_S).distance;
  return distance * distance;
}

double extent(const PieceShape& shape) {
  if (const auto* disk = std::get_if<DiskPiece>(&shape)) return disk->radius;
  if (const auto* pin = std::get_if<PinPiece>(&shape)) return pin->radius;
  const Shape& solid = *std::get_if<Shape>(&shape);
  if (const auto* ball = std::get_if<Ball>(&solid)) return ball->radius;
  if (const auto* box = std::get_if<RoundedBox>(&solid)) return box->half_size.maxCoeff();
  if (const auto* cylinder = std::get_if<RoundedCylinder>(&solid)) {
    return std::max(cylinder->radius, cylinder->half_length);
  }
  const auto* mesh = std::get_if<MeshShape>(&solid);
  return mesh != nullptr ? 0.5 * (*mesh)->content().bounds.sizes().maxCoeff() : 0.0;
}

double face_reach(const PieceShape& shape) {
  if (const auto* disk = std::get_if<DiskPiece>(&shape)) return disk->radius;
  if (const auto* pin = std::get_if<PinPiece>(&shape)) return pin->radius;
  return solid_reach(shape);
}

double solid_reach(const PieceShape& shape) {
  if (const auto* solid = std::get_if<Shape>(&shape)) {
    if (const auto* ball = std::get_if<Ball>(solid)) return ball->radius;
    if (const auto* box = std::get_if<RoundedBox>(solid)) return box->half_size.norm();
    if (const auto* cylinder = std::get_if<RoundedCylinder>(solid)) {
      return std::hypot(cylinder->radius, cylinder->half_length);
    }
  }
  return std::numeric_limits<double>::infinity();
}

SignedDistance solid_distance(const PieceShape& shape, const Vector3& p_S) {
  if (const auto* disk = std::get_if<DiskPiece>(&shape)) return distance_of_disk(disk->radius, p_S);
  if (const auto* pin = std::get_if<PinPiece>(&shape)) return distance_of_pin(pin->radius, p_S);
  return signed_distance(*std::get_if<Shape>(&shape), p_S);
}

SolidPiece solid_piece(const PieceShape& shape, const Pose& X_FS) {
  if (const auto* disk = std::get_if<DiskPiece>(&shape)) {
    return disk_solid(disk->radius, disk->edge_radius, X_FS);
  }
  if (const auto* pin = std::get_if<PinPiece>(&shape)) {
    return {RoundedCylinder{pin->radius, kPinHalfLength, std::min(kPinEdge, pin->radius)},
            X_FS * Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -kPinHalfLength)}};
  }
  return {*std::get_if<Shape>(&shape), X_FS};
}

}  // namespace softfinger
