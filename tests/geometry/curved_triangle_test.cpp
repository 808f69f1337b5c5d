#include "softfinger/geometry/curved_triangle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace softfinger {
namespace {

std::array<Vector3, 3> on_unit_ball(double spread, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-spread, spread);
  std::array<Vector3, 3> points;
  for (Vector3& point : points) {
    point = Vector3(any(random), any(random), 1.0).normalized();
  }
  return points;
}

std::array<double, 3> weights_of(double a, double b) { return {a, b, 1.0 - a - b}; }

TEST(CurvedTriangle, HasItsCorners) {
  std::mt19937_64 random(1);
  const auto points = on_unit_ball(0.5, random);
  const CurvedTriangle curved(points, points);
  EXPECT_EQ(curved.at({1.0, 0.0, 0.0}), points[0]);
  EXPECT_EQ(curved.at({0.0, 1.0, 0.0}), points[1]);
  EXPECT_EQ(curved.at({0.0, 0.0, 1.0}), points[2]);
}

// The flat triangle is off by the square of its size, the curved one by the fourth power.
TEST(CurvedTriangle, FollowsABallToTheFourthOrder) {
  std::mt19937_64 random(2);
  for (int triangle = 0; triangle < 50; ++triangle) {
    std::array<double, 2> curved_off{}, flat_off{};
    const auto wide = on_unit_ball(0.4, random);
    const Vector3 centre = (wide[0] + wide[1] + wide[2]).normalized();
    for (std::size_t size = 0; size < 2; ++size) {
      std::array<Vector3, 3> points;
      for (std::size_t k = 0; k < 3; ++k) {
        points[k] = (size == 0 ? wide[k] : Vector3(0.5 * (wide[k] + centre))).normalized();
      }
      const CurvedTriangle curved(points, points);
      for (double a = 0.0; a <= 1.0; a += 0.125) {
        for (double b = 0.0; a + b <= 1.0; b += 0.125) {
          const auto w = weights_of(a, b);
          const Vector3 flat = w[0] * points[0] + w[1] * points[1] + w[2] * points[2];
          flat_off[size] = std::max(flat_off[size], std::abs(flat.norm() - 1.0));
          curved_off[size] = std::max(curved_off[size], std::abs(curved.at(w).norm() - 1.0));
        }
      }
    }
    EXPECT_LT(curved_off[0], 0.25 * flat_off[0]);
    EXPECT_LT(curved_off[1], curved_off[0] / 11.0);
    EXPECT_GT(flat_off[1], flat_off[0] / 5.0);
  }
}

TEST(CurvedTriangle, MeetsItsNeighbourAlongTheirSide) {
  std::mt19937_64 random(3);
  const auto points = on_unit_ball(0.5, random);
  const Vector3 other = Vector3(0.9, 0.9, 1.0).normalized();
  const CurvedTriangle curved(points, points);
  const CurvedTriangle neighbour({points[1], points[0], other}, {points[1], points[0], other});
  for (double a = 0.0; a <= 1.0; a += 0.1) {
    EXPECT_LT((curved.at({a, 1.0 - a, 0.0}) - neighbour.at({1.0 - a, a, 0.0})).norm(), 1e-15);
  }
}

TEST(CurvedTriangle, IsFlatWhereItsNormalsAreItsOwn) {
  const std::array<Vector3, 3> points{Vector3(0, 0, 0), Vector3(2, 0, 0), Vector3(0, 3, 0)};
  const CurvedTriangle curved(points, {Vector3::UnitZ(), Vector3::UnitZ(), Vector3::UnitZ()});
  for (double a = 0.0; a <= 1.0; a += 0.25) {
    for (double b = 0.0; a + b <= 1.0; b += 0.25) {
      EXPECT_LT((curved.at(weights_of(a, b)) - Vector3(2.0 * b, 3.0 * (1.0 - a - b), 0)).norm(),
                1e-15);
    }
  }
}

}  // namespace
}  // namespace softfinger
