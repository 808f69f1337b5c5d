#include "softfinger/geometry/mass_properties.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "generated_mesh.hpp"
#include "softfinger/geometry/grid_sampling.hpp"
#include "softfinger/geometry/signed_distance_grid.hpp"

namespace softfinger {
namespace {

constexpr double kCircle = std::numbers::pi;

/// All about the origin. `relative`: of the volume, and of the trace of second moments.
void expect_moments(const Shape& shape, double volume, const Vector3& per_volume, double relative) {
  const auto even = mass_properties(shape);
  ASSERT_TRUE(even.has_value());
  EXPECT_NEAR(even->volume, volume, relative * volume);
  const double size = std::sqrt(per_volume.sum());
  EXPECT_LT(even->centre_O.norm(), std::max(1e-15, 0.1 * relative * size));
  const Matrix3 second = volume * per_volume.asDiagonal().toDenseMatrix();
  EXPECT_LT((even->second_moment_O - second).norm(), relative * second.trace());
}

MeshShape solid_of(TriangleMesh mesh, double spacing = 0.5e-3) {
  const ClosedSurface surface = closed_surface(std::move(mesh), "mesh");
  const TriangleTree tree(surface);
  return std::make_shared<const SignedDistanceGrid>(
      sample_distance(surface, tree, spacing, 3e-3, "mesh"), "mesh", 0);
}

/// By a grid of points in the solid: no cells that the surface cuts in parts.
MassProperties by_points(const Shape& shape) {
  constexpr int kPoints = 120;
  const Eigen::AlignedBox3d box = bounds(shape);
  const Vector3 cell = box.sizes() / kPoints;
  MassProperties sum;
  for (int i = 0; i < kPoints; ++i) {
    for (int j = 0; j < kPoints; ++j) {
      for (int k = 0; k < kPoints; ++k) {
        const Vector3 x = box.min() + cell.cwiseProduct(Vector3(i + 0.5, j + 0.5, k + 0.5));
        if (signed_distance(shape, x).distance >= 0.0) continue;
        sum.volume += cell.prod();
        sum.second_moment_O += cell.prod() * x * x.transpose();
      }
    }
  }
  return sum;
}

TEST(MassProperties, AreThoseOfTextbooks) {
  const double r = 0.02;
  expect_moments(Ball{r}, 4.0 / 3.0 * kCircle * r * r * r, Vector3::Constant(r * r / 5.0), 1e-13);
  const Vector3 half(0.03, 0.02, 0.005);
  expect_moments(RoundedBox{half, 0.0}, 8.0 * half.prod(), half.cwiseAbs2() / 3.0, 1e-13);
  const double l = 0.05;
  expect_moments(RoundedCylinder{r, l, 0.0}, kCircle * r * r * 2.0 * l,
                 Vector3(r * r / 4.0, r * r / 4.0, l * l / 3.0), 1e-13);
}

TEST(MassProperties, AreABallsWhereEdgesAreAsRoundAsThat) {
  const double r = 0.015;
  const MassProperties ball = *mass_properties(Ball{r});
  for (const Shape& shape :
       {Shape(RoundedBox{Vector3::Constant(r), r}), Shape(RoundedCylinder{r, r, r})}) {
    expect_moments(shape, ball.volume, ball.second_moment_O.diagonal() / ball.volume, 1e-13);
  }
}

TEST(MassProperties, VolumesAreSteinersAndMomentsThoseOfAGridOfPoints) {
  const RoundedBox box{{0.03, 0.02, 0.008}, 0.005};
  const RoundedCylinder cylinder{0.02, 0.012, 0.007};
  const double r = box.edge_radius;
  const Vector3 side = 2.0 * (box.half_size.array() - r);
  const double area = side.x() * side.y() + side.y() * side.z() + side.z() * side.x();
  EXPECT_NEAR(
      mass_properties(box)->volume,
      side.prod() + 2.0 * r * area + kCircle * r * r * side.sum() + 4.0 / 3.0 * kCircle * r * r * r,
      1e-18);
  const double e = cylinder.edge_radius;
  const double inner = cylinder.radius - e;
  const double length = 2.0 * (cylinder.half_length - e);
  EXPECT_NEAR(mass_properties(cylinder)->volume,
              kCircle * inner * inner * length + 2.0 * kCircle * inner * (inner + length) * e +
                  kCircle * (kCircle * inner + length) * e * e + 4.0 / 3.0 * kCircle * e * e * e,
              1e-18);
  for (const Shape& shape : {Shape(box), Shape(cylinder)}) {
    const MassProperties points = by_points(shape);
    expect_moments(shape, points.volume, points.second_moment_O.diagonal() / points.volume, 1e-3);
  }
}

/// Exact, by tetrahedra from the origin to each triangle.
MassProperties by_triangles(const TriangleMesh& mesh) {
  MassProperties sum;
  for (const auto& triangle : mesh.triangles) {
    const Vector3 a = mesh.positions[static_cast<std::size_t>(triangle[0])];
    const Vector3 b = mesh.positions[static_cast<std::size_t>(triangle[1])];
    const Vector3 c = mesh.positions[static_cast<std::size_t>(triangle[2])];
    const double six_volumes = a.dot(b.cross(c));
    const Vector3 all = a + b + c;
    sum.volume += six_volumes / 6.0;
    sum.second_moment_O +=
        six_volumes / 120.0 *
        (all * all.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  return sum;
}

TEST(MassProperties, OfMeshesAreThoseOfTheirTriangles) {
  for (const TriangleMesh& mesh :
       {sphere_mesh(8e-3, 20), torus_mesh(9e-3, 4e-3, 80, 40), tunnel_mesh(6e-3, 2.5e-3)}) {
    const MassProperties exact = by_triangles(mesh);
    expect_moments(solid_of(mesh), exact.volume, exact.second_moment_O.diagonal() / exact.volume,
                   3e-3);
  }
}

TEST(MassProperties, OfAMeshMoveWithIt) {
  const TriangleMesh mesh = box_mesh({10e-3, 6e-3, 4e-3});
  const Pose X{exp_rotation(Vector3(0.4, -0.7, 1.1)), {5e-3, -20e-3, 7e-3}};
  const MassProperties at_home = *mass_properties(solid_of(mesh));
  const MassProperties away = *mass_properties(solid_of(moved(mesh, X)));
  EXPECT_NEAR(away.volume, at_home.volume, 5e-3 * at_home.volume);
  EXPECT_LT((away.centre_O - X.translation).norm(), 5e-6);
  const Matrix3 turned = X.rotation * at_home.second_moment_O * X.rotation.transpose();
  EXPECT_LT((away.second_moment_O - turned).norm(), 5e-3 * turned.trace());
}

TEST(MassProperties, OfAHalfSpaceAreNone) {
  EXPECT_FALSE(mass_properties(HalfSpace{}).has_value());
}

}  // namespace
}  // namespace softfinger
