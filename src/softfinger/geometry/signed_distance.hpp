#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <variant>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Signed distance to a solid and its derivatives at one point, in the frame of the query.
/// Positive outside, zero on the surface, negative inside; metres.
struct SignedDistance {
  double distance = 0.0;
  Vector3 gradient = Vector3::UnitZ();  ///< unit outward normal
  Matrix3 hessian = Matrix3::Zero();    ///< 1/m; the surface's curvature
};

/// The half space z <= 0 of its own frame.
struct HalfSpace {};
/// Ball about the origin. radius > 0, metres.
struct Ball {
  double radius;
};
/// Box about the origin, edges rounded: the set of points within edge_radius of the inner box of
/// half extents half_size - edge_radius. 0 <= edge_radius <= least half size; metres.
struct RoundedBox {
  Vector3 half_size;
  double edge_radius;
};
/// Cylinder along z about the origin, rims rounded by edge_radius (0 <= edge_radius <=
/// min(radius, half_length)); metres.
struct RoundedCylinder {
  double radius;
  double half_length;
  double edge_radius;
};

/// Two balls whose centres lie on the x axis, `back` at -half_length and `front` at +half_length,
/// and all that lies between them: their convex hull. radii > 0, |back - front| < 2 half_length;
/// metres.
struct TaperedCapsule {
  double back;
  double front;
  double half_length;
};

class SignedDistanceGrid;
/// The solid a closed triangle mesh encloses, about its own origin; never null.
using MeshShape = std::shared_ptr<const SignedDistanceGrid>;

using Shape = std::variant<HalfSpace, Ball, RoundedBox, RoundedCylinder, MeshShape, TaperedCapsule>;

/// Signed distance of the point p_O, all in the shape's own frame O. The gradient is continuous
/// outside the solid and inside it as far as the edge radius (C1 distance, so Newton does not
/// cycle). A mesh's gradient is that of its grid: of unit length up to the error of interpolation,
/// shorter where an edge is rounded.
[[nodiscard]] SignedDistance signed_distance(const Shape& shape, const Vector3& p_O);
/// The same; the Hessian may be left zero, where that is quicker.
[[nodiscard]] SignedDistance distance_and_gradient(const Shape& shape, const Vector3& p_O);

/// Least box along the axes of O that holds the solid, m; endless for a half space.
[[nodiscard]] Eigen::AlignedBox3d bounds(const Shape& shape);

/// Unit normal by a gradient, which an interpolated distance has not of unit length near its edges.
/// Where there is none at all any direction is as good.
[[nodiscard]] inline Vector3 unit_normal(const Vector3& gradient) {
  const double length = gradient.norm();
  return length > 0.0 ? Vector3(gradient / length) : Vector3::UnitZ();
}

}  // namespace softfinger
