#pragma once

#include <vector>

#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {

/// A ball inside a solid that touches its surface, in the solid's frame O; metres.
struct SurfacePoint {
  Vector3 centre_O = Vector3::Zero();
  double radius = 0.0;
  /// Of a rim about z, to the next point, rad; else 0.
  double spacing = 0.0;
  /// Of a tapered capsule, of the strip that it stands for: as long as to its neighbours and as
  /// broad as its radius, m^2; else 0.
  double area = 0.0;
};

/// Where a rigid solid may touch another: balls at its corners and along its edges, as round as
/// these are, and on large faces; always the same in the same order. One ball for a ball; balls
/// along the axis of a tapered capsule; none for a half space.
[[nodiscard]] std::vector<SurfacePoint> surface_points(const Shape& shape);

}  // namespace softfinger
