#include "softfinger/contact/feature_area.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace softfinger {
namespace {

using Corners = std::array<Vector3, 3>;
using Weights = std::array<double, 3>;

Vector3 point_of(const Corners& corners, const Weights& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

/// By asking a lattice of points inside the triangle what they are nearest to.
double part_by_counting(const Corners& corners, const Weights& weights) {
  constexpr int kFine = 400;
  const Vector3 p = point_of(corners, weights);
  int nearer = 0, all = 0;
  for (int i = 0; i < kFine; ++i) {
    for (int j = 0; j < kFine - i; ++j) {
      const double u = (i + 1.0 / 3.0) / kFine;
      const double v = (j + 1.0 / 3.0) / kFine;
      const Vector3 x = point_of(corners, {u, v, 1.0 - u - v});
      const double to_corner =
          std::min({(x - corners[0]).norm(), (x - corners[1]).norm(), (x - corners[2]).norm()});
      ++all;
      nearer += (x - p).norm() < to_corner ? 1 : 0;
    }
  }
  return static_cast<double>(nearer) / all;
}

TEST(FeatureArea, IsWhatALatticeOfPointsCounts) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.0, 1.0), weight(0.02, 1.0);
  for (int number = 0; number < 40; ++number) {
    Corners corners;
    for (Vector3& corner : corners) {
      corner = 1e-3 * Vector3(place(random), place(random), place(random)) + Vector3(0.1, 0, -0.2);
    }
    Weights weights{weight(random), weight(random), weight(random)};
    const double sum = weights[0] + weights[1] + weights[2];
    for (double& w : weights) w /= sum;
    EXPECT_NEAR(part_nearer_than_corners(corners, weights), part_by_counting(corners, weights),
                0.015)
        << number;
  }
}

// Of an equilateral triangle its centre has the hexagon between the bisectors: two thirds.
TEST(FeatureArea, OfACentreIsTwoThirds) {
  const Corners corners{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0.5, std::sqrt(0.75), 0)};
  EXPECT_NEAR(part_nearer_than_corners(corners, {1.0 / 3, 1.0 / 3, 1.0 / 3}), 2.0 / 3.0, 1e-12);
  // Half of the way along a side: what is nearer to it than to the ends, cut by the third corner's.
  EXPECT_NEAR(part_nearer_than_corners(corners, {0.5, 0.5, 0.0}),
              part_by_counting(corners, {0.5, 0.5, 0.0}), 0.01);
}

TEST(FeatureArea, HasAMeaningAtCornersAndWithoutArea) {
  const Corners corners{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)};
  // What is nearer to the right angle than to the others is half of the triangle.
  EXPECT_NEAR(part_nearer_than_corners(corners, {1.0, 0.0, 0.0}), 0.5, 1e-12);
  const Corners flat{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(2, 0, 0)};
  EXPECT_EQ(part_nearer_than_corners(flat, {0.2, 0.3, 0.5}), 0.0);
}

}  // namespace
}  // namespace softfinger
