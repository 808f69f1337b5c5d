#include "softfinger/contact/deepest_point.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

using Corners = std::array<Vector3, 3>;

/// A triangle of the size of the skin's, near a solid at the origin.
Corners drawn_triangle(std::mt19937& random, double away) {
  std::normal_distribution<double> normal;
  const auto drawn = [&] { return Vector3{normal(random), normal(random), normal(random)}; };
  const Vector3 centre = away * drawn().normalized();
  return {centre + 1 * mm * drawn(), centre + 1 * mm * drawn(), centre + 1 * mm * drawn()};
}

/// The least gap of a fine grid of points of the triangle.
double least_gap(const Shape& shape, const Corners& corners) {
  constexpr int kParts = 60;
  double least = 1.0;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; i + j <= kParts; ++j) {
      const double a = static_cast<double>(i) / kParts, b = static_cast<double>(j) / kParts;
      least =
          std::min(least, signed_distance(shape, point_at(corners, {a, b, 1.0 - a - b})).distance);
    }
  }
  return least;
}

/// Weights of a point of the triangle, and its gap.
void expect_point_of(const Shape& shape, const Corners& corners, const TrianglePoint& point) {
  EXPECT_NEAR(point.weights[0] + point.weights[1] + point.weights[2], 1.0, 1e-12);
  for (const double weight : point.weights) EXPECT_GE(weight, -1e-12);
  EXPECT_EQ(point.gap, signed_distance(shape, point_at(corners, point.weights)).distance);
}

const std::vector<Shape> kSolids{HalfSpace{}, Ball{2 * mm},
                                 RoundedBox{Vector3(1, 1.5, 2) * mm, 0.2 * mm},
                                 RoundedCylinder{1 * mm, 2 * mm, 0.2 * mm}};

// The solids are convex, so the gap has one minimum: of a ball it is found at once, of others by
// and by, as the skin stays with a feature from step to step.
TEST(DeepestPoint, ComesToBeAsDeepAsAnyPointOfTheTriangle) {
  std::mt19937 random(1);
  for (const Shape& solid : kSolids) {
    const int calls = std::holds_alternative<Ball>(solid) ? 1 : 20;
    for (int k = 0; k < 60; ++k) {
      const Corners corners = drawn_triangle(random, 3 * mm);
      TrianglePoint point = least_of_few(solid, {}, corners);
      for (int call = 0; call < calls; ++call) {
        expect_point_of(solid, corners, point);
        const TrianglePoint deeper = deepest_point(solid, {}, corners, point);
        EXPECT_LE(deeper.gap, point.gap);
        point = deeper;
      }
      expect_point_of(solid, corners, point);
      // At a sharp edge the way down may end early.
      EXPECT_LE(point.gap, least_gap(solid, corners) + 30e-6) << solid.index() << ' ' << k;
    }
  }
}

TEST(DeepestPoint, DoesNotKnowTheOrderOfTheCorners) {
  std::mt19937 random(2);
  for (int k = 0; k < 50; ++k) {
    const Corners c = drawn_triangle(random, 3 * mm);
    const TrianglePoint one = deepest_point(kSolids[1], {}, c, least_of_few(kSolids[1], {}, c));
    const Corners turned{c[1], c[2], c[0]};
    const TrianglePoint other =
        deepest_point(kSolids[1], {}, turned, least_of_few(kSolids[1], {}, turned));
    EXPECT_NEAR(one.gap, other.gap, 1e-6);
  }
}

// Seen from one side of a thin plate, deep is what went far through, not what is half-way.
TEST(DeepestPoint, IsSeenFromTheSideItCameFrom) {
  const Shape plate = RoundedBox{Vector3(20, 20, 0.5) * mm, 0.1 * mm};
  const ContactSide above{Vector3(0, 0, 0.5) * mm, Vector3::UnitZ(), true};
  const Corners corners{Vector3(0, 0, 0.4) * mm, Vector3(1, 0, 0.2) * mm, Vector3(0, 1, -0.4) * mm};
  const TrianglePoint point =
      deepest_point(plate, above, corners, least_of_few(plate, above, corners));
  EXPECT_NEAR(point.weights[2], 1.0, 1e-3);
  EXPECT_NEAR(point.gap, -0.9 * mm, 1e-6);
  EXPECT_GT(deepest_point(plate, {}, corners, least_of_few(plate, {}, corners)).gap, -0.55 * mm);
}

}  // namespace
}  // namespace softfinger
