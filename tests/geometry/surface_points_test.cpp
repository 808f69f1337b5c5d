#include "softfinger/geometry/surface_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "generated_mesh.hpp"
#include "softfinger/geometry/grid_sampling.hpp"
#include "softfinger/geometry/signed_distance_grid.hpp"

namespace softfinger {
namespace {

std::vector<Shape> roundings_of_all() {
  std::vector<Shape> shapes{Ball{0.02}};
  for (const double edge : {0.0, 1e-3, 5e-3}) {
    shapes.emplace_back(RoundedBox{{0.03, 0.02, 0.005}, edge});
    shapes.emplace_back(RoundedCylinder{0.02, 0.005, edge});
    shapes.emplace_back(RoundedCylinder{0.005, 0.04, edge});
  }
  shapes.emplace_back(RoundedBox{Vector3::Constant(5e-3), 5e-3});
  return shapes;
}

/// How far the balls reach along a direction, m.
double reach(const std::vector<SurfacePoint>& points, const Vector3& direction) {
  double most = -std::numeric_limits<double>::infinity();
  for (const SurfacePoint& p : points) most = std::max(most, p.centre_O.dot(direction) + p.radius);
  return most;
}

double distance_to_nearest(const std::vector<SurfacePoint>& points, const Vector3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const SurfacePoint& p : points) least = std::min(least, (p.centre_O - x).norm());
  return least;
}

TEST(SurfacePoints, AreBallsInsideThatTouchTheSurface) {
  for (const Shape& shape : roundings_of_all()) {
    const std::vector<SurfacePoint> points = surface_points(shape);
    ASSERT_FALSE(points.empty());
    for (const SurfacePoint& point : points) {
      EXPECT_NEAR(-signed_distance(shape, point.centre_O).distance, point.radius, 1e-12)
          << shape.index();
    }
  }
}

TEST(SurfacePoints, StandNowhereTwice) {
  for (const Shape& shape : roundings_of_all()) {
    std::vector<SurfacePoint> points = surface_points(shape);
    while (!points.empty()) {
      const Vector3 last = points.back().centre_O;
      points.pop_back();
      EXPECT_GT(distance_to_nearest(points, last), 1e-6) << shape.index();
    }
  }
}

TEST(SurfacePoints, OfABoxReachAsFarAsItDoes) {
  const RoundedBox box{{0.03, 0.02, 0.005}, 2e-3};
  const std::vector<SurfacePoint> points = surface_points(box);
  const Vector3 inner = box.half_size.array() - box.edge_radius;
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_TRUE(points[i].centre_O.cwiseAbs().isApprox(inner, 1e-14)) << "corners are first";
  }
  std::mt19937 generator(1);
  std::normal_distribution<double> x;
  for (int i = 0; i < 1000; ++i) {
    const Vector3 direction = Vector3(x(generator), x(generator), x(generator)).normalized();
    EXPECT_NEAR(reach(points, direction), inner.dot(direction.cwiseAbs()) + box.edge_radius, 1e-12);
  }
}

TEST(SurfacePoints, LieAlongEdgesOfABoxNoFurtherApartThanAQuarter) {
  const RoundedBox box{{0.03, 0.02, 0.005}, 0.0};
  const std::vector<SurfacePoint> points = surface_points(box);
  for (int axis = 0; axis < 3; ++axis) {
    for (double part = -1.0; part <= 1.0; part += 0.01) {
      Vector3 at = box.half_size;
      at[axis] *= part;
      EXPECT_LE(distance_to_nearest(points, at), box.half_size[axis] / 4.0 + 1e-12);
    }
  }
}

TEST(SurfacePoints, OfACylinderAreRoundToAFewMicrometres) {
  const RoundedCylinder cylinder{0.01, 0.02, 1e-3};
  const std::vector<SurfacePoint> points = surface_points(cylinder);
  for (double angle = 0.0; angle < 7.0; angle += 0.01) {
    const Vector3 across(std::cos(angle), std::sin(angle), 0.0);
    EXPECT_LE(reach(points, across), cylinder.radius + 1e-12);
    EXPECT_GE(reach(points, across), cylinder.radius - 20e-6);
  }
  EXPECT_NEAR(reach(points, Vector3::UnitZ()), cylinder.half_length, 1e-12);
  // Between its rims too: what stands upright beside it touches it there.
  const auto between = std::ranges::count_if(
      points, [](const SurfacePoint& p) { return std::abs(p.centre_O.z()) < 0.011; });
  EXPECT_GE(between, 3 * 24);
}

TEST(SurfacePoints, OfAMeshLieOnItWithItsCornersAmongThem) {
  const Vector3 half(10e-3, 6e-3, 4e-3);
  const ClosedSurface surface = closed_surface(box_mesh(half), "mesh");
  const TriangleTree tree(surface);
  const MeshShape box = std::make_shared<const SignedDistanceGrid>(
      sample_distance(surface, tree, 0.25e-3, 3e-3, "mesh"), "mesh", 0);
  const std::vector<SurfacePoint> points = surface_points(box);
  EXPECT_LE(points.size(), 400U);
  for (const SurfacePoint& point : points) {
    EXPECT_EQ(point.radius, 0.0);
    EXPECT_LT(std::abs(signed_distance(box, point.centre_O).distance), 1e-6);
  }
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    EXPECT_LT(distance_to_nearest(points, half.cwiseProduct(sign)), 0.5e-3) << corner;
  }
  // Spread evenly: 300 on 992 mm^2.
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> x(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    Vector3 at = half.cwiseProduct(Vector3(x(generator), x(generator), x(generator)));
    at[i % 3] = std::copysign(half[i % 3], at[i % 3]);
    EXPECT_LT(distance_to_nearest(points, at), 2.2e-3);
  }
}

TEST(SurfacePoints, OfAHalfSpaceAreNone) { EXPECT_TRUE(surface_points(HalfSpace{}).empty()); }

}  // namespace
}  // namespace softfinger
