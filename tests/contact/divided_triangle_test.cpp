#include "softfinger/contact/divided_triangle.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace softfinger {
namespace {

using Weights = DividedTriangle::Weights;

std::vector<Weights> anywhere_in_triangle(int count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  std::vector<Weights> places;
  while (static_cast<int>(places.size()) < count) {
    const double a = any(random), b = any(random);
    if (a + b <= 1.0) places.push_back({a, b, 1.0 - a - b});
  }
  return places;
}

/// With corners a metre apart, and an excess that is linear all over it.
constexpr std::array<double, 3> kAtCorners{-0.3, 0.5, 0.9};
double linear(const Weights& w) {
  return w[0] * kAtCorners[0] + w[1] * kAtCorners[1] + w[2] * kAtCorners[2];
}
SkinPoint point_at(const Weights& w) { return {Vector3(w[1], w[2], 0.0), linear(w)}; }

DividedTriangle linear_triangle() {
  DividedTriangle triangle;
  for (std::size_t k = 0; k < TriangleLattice::kPlaces; ++k) {
    triangle.places[k] = point_at(TriangleLattice::get().weights[k]);
  }
  return triangle;
}

TEST(DividedTriangle, IsLinearBetweenItsPlaces) {
  DividedTriangle triangle = linear_triangle();
  const auto check = [&] {
    for (const Weights& place : anywhere_in_triangle(200)) {
      EXPECT_NEAR(triangle.excess_at(place), linear(place), 1e-12);
    }
    // The corner below zero, cut at 3/8 and 1/4 of its sides.
    EXPECT_NEAR(triangle.area_within(), 0.5 * 0.375 * 0.25, 1e-12);
  };
  check();
  for (const Weights& feature : anywhere_in_triangle(3)) {
    triangle.divide_at(feature, point_at(feature));
    check();
  }
}

TEST(DividedTriangle, HasTheExcessOfAFeatureThere) {
  DividedTriangle triangle;
  for (std::size_t k = 0; k < TriangleLattice::kPlaces; ++k) {
    triangle.places[k] = {point_at(TriangleLattice::get().weights[k]).position_F, 1.0};
  }
  EXPECT_EQ(triangle.area_within(), 0.0);
  const Weights feature{0.6, 0.3, 0.1};
  triangle.divide_at(feature, {point_at(feature).position_F, -1.0});
  EXPECT_NEAR(triangle.excess_at(feature), -1.0, 1e-12);
  EXPECT_NEAR(triangle.excess_at({0.1, 0.2, 0.7}), 1.0, 1e-12);
  // Half of the way from it to its part's corners: a quarter of that part.
  EXPECT_NEAR(triangle.area_within(), 0.25 * 0.125, 1e-12);
  int within = 0;
  const std::vector<Weights> places = anywhere_in_triangle(20000);
  for (const Weights& place : places) within += triangle.excess_at(place) <= 0.0 ? 1 : 0;
  EXPECT_NEAR(within / 20000.0, 0.25 * 0.125 / 0.5, 0.006);
}

}  // namespace
}  // namespace softfinger
