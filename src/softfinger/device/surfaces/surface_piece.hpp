#pragma once

#include <variant>

#include "softfinger/device/contacting_surface.hpp"
#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {

/// The disk of disk_geometry.hpp.
struct DiskPiece {
  double radius;
  double edge_radius;  ///< of its solid's rim
};
/// The flat end {z = 0, rho <= radius} of a pin, the solid {z <= 0, rho <= radius}.
struct PinPiece {
  double radius;
};
/// One rigid part of a contacting surface, in its own frame S.
using PieceShape = std::variant<DiskPiece, PinPiece, Shape>;

struct SurfacePiece {
  int body = 0;  ///< which body carries it
  Pose X_LS;     ///< S on the body
  PieceShape shape;
};

/// How a point lies to the nearest point of a piece.
struct NearestPoint {
  double squared_distance = 0.0;             ///< m^2
  Vector3 residual = Vector3::Zero();        ///< from the nearest point, m, in S
  Vector3 gradient = Vector3::Zero();        ///< of half the squared distance by p_S
  Matrix3 derivative = Matrix3::Identity();  ///< of the gradient by p_S
};
/// Of disks and pins the flat face, of other shapes the whole surface.
[[nodiscard]] NearestPoint nearest_point(const PieceShape& shape, const Vector3& p_S);
/// Its squared_distance alone.
[[nodiscard]] double squared_face_distance(const PieceShape& shape, const Vector3& p_S);

/// How far the piece reaches from its origin along its own axes, m.
[[nodiscard]] double extent(const PieceShape& shape);

/// No point of the piece's face, or of its solid, is farther than this from its origin, m; infinity
/// where that has no end or is not known.
[[nodiscard]] double face_reach(const PieceShape& shape);
[[nodiscard]] double solid_reach(const PieceShape& shape);

/// Signed distance to the piece's solid with its derivatives by p_S.
[[nodiscard]] SignedDistance solid_distance(const PieceShape& shape, const Vector3& p_S);

/// The solid that presses a finger.
[[nodiscard]] SolidPiece solid_piece(const PieceShape& shape, const Pose& X_FS);

}  // namespace softfinger
