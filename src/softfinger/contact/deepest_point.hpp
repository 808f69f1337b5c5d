#pragma once

#include <array>

#include "softfinger/contact/contact_side.hpp"

namespace softfinger {

/// A point of a triangle, by barycentric weights, and its gap to a solid, m.
struct TrianglePoint {
  std::array<double, 3> weights{};
  double gap = 0.0;
};

/// Where in the triangle (corners in the shape's frame, m) the gap is least, by descent from
/// `start`: to the nearest point of the solid shrunk a little, and back to the triangle. A local
/// minimum, and not exactly: a few evaluations a step are enough to stay with a feature that moves.
/// Gaps are those seen from `side`.
[[nodiscard]] TrianglePoint deepest_point(const Shape& shape, const ContactSide& side,
                                          const std::array<Vector3, 3>& corners_O,
                                          const TrianglePoint& start);

/// Where the gap is least among the centre and three points around it; there to start from.
[[nodiscard]] TrianglePoint least_of_few(const Shape& shape, const ContactSide& side,
                                         const std::array<Vector3, 3>& corners_O);

[[nodiscard]] inline Vector3 point_at(const std::array<Vector3, 3>& corners,
                                      const std::array<double, 3>& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

}  // namespace softfinger
