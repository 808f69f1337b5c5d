#include "softfinger/contact/feature_area.hpp"

#include <algorithm>
#include <cstddef>

namespace softfinger {
namespace {

/// A convex polygon inside a triangle: three half-planes cut it to six corners at most.
struct Polygon {
  std::array<Vector3, 6> corners;
  std::size_t count = 0;
  void add(const Vector3& p) {
    if (count < corners.size()) corners[count++] = p;
  }
};

/// What of the polygon has normal.dot(p) <= offset.
Polygon cut(const Polygon& polygon, const Vector3& normal, double offset) {
  Polygon rest;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const Vector3& a = polygon.corners[k];
    const Vector3& b = polygon.corners[(k + 1) % polygon.count];
    const double out_a = normal.dot(a) - offset;
    const double out_b = normal.dot(b) - offset;
    if (out_a <= 0.0) rest.add(a);
    if ((out_a < 0.0 && out_b > 0.0) || (out_a > 0.0 && out_b < 0.0)) {
      rest.add(a + out_a / (out_a - out_b) * (b - a));
    }
  }
  return rest;
}

double doubled_area(const Polygon& polygon) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t k = 2; k < polygon.count; ++k) {
    sum += (polygon.corners[k - 1] - polygon.corners[0])
               .cross(polygon.corners[k] - polygon.corners[0]);
  }
  return sum.norm();
}

}  // namespace

double part_nearer_than_corners(const std::array<Vector3, 3>& corners,
                                const std::array<double, 3>& weights) {
  // Seen from the first corner, so that a triangle far from the origin loses no digits.
  Polygon polygon;
  for (const Vector3& corner : corners) polygon.add(corner - corners[0]);
  const double all = doubled_area(polygon);
  Vector3 point = Vector3::Zero();
  for (std::size_t k = 0; k < 3; ++k) point += weights[k] * polygon.corners[k];
  if (!(all > 0.0)) return 0.0;
  for (const Vector3& corner : corners) {
    const Vector3 away = corner - corners[0] - point;
    if (!(away.squaredNorm() > 0.0)) continue;
    polygon = cut(polygon, away, away.dot(point + 0.5 * away));
  }
  return std::min(1.0, doubled_area(polygon) / all);
}

}  // namespace softfinger
