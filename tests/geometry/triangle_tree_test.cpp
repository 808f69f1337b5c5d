#include "softfinger/geometry/triangle_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "generated_mesh.hpp"
#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {
namespace {

Vector3 random_point(std::mt19937& generator, double half) {
  std::uniform_real_distribution<double> x(-half, half);
  return {x(generator), x(generator), x(generator)};
}

/// Distance to a triangle by projecting and, failing that, by its sides: another way than the
/// tree's.
double triangle_distance(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& p) {
  const Vector3 n = (b - a).cross(c - a).normalized();
  const Vector3 q = p - n * n.dot(p - a);
  const bool inside = (b - a).cross(q - a).dot(n) >= 0.0 && (c - b).cross(q - b).dot(n) >= 0.0 &&
                      (a - c).cross(q - c).dot(n) >= 0.0;
  if (inside) return std::abs(n.dot(p - a));
  const auto to_side = [&](const Vector3& u, const Vector3& v) {
    const double t = std::clamp((v - u).dot(p - u) / (v - u).squaredNorm(), 0.0, 1.0);
    return (u + t * (v - u) - p).norm();
  };
  return std::min({to_side(a, b), to_side(b, c), to_side(c, a)});
}

TEST(TriangleTree, FindsWhatASearchOfAllTrianglesFinds) {
  const ClosedSurface surface = closed_surface(torus_mesh(0.02, 0.008, 60, 30), "torus");
  const TriangleTree tree(surface);
  std::mt19937 generator(1);
  for (int i = 0; i < 500; ++i) {
    const Vector3 p = random_point(generator, 0.04);
    double least = std::numeric_limits<double>::infinity();
    for (int t = 0; t < static_cast<int>(surface.mesh.triangles.size()); ++t) {
      least = std::min(least, triangle_distance(surface.corner(t, 0), surface.corner(t, 1),
                                                surface.corner(t, 2), p));
    }
    const TriangleTree::Closest closest = tree.closest(p);
    EXPECT_NEAR(std::abs(closest.distance), least, 1e-15);
    EXPECT_NEAR((closest.point - p).norm(), least, 1e-15);
    // A hint changes nothing, however bad.
    EXPECT_EQ(tree.closest(p, i).distance, closest.distance);
    EXPECT_EQ(tree.closest(p, i, 1.001 * least).distance, closest.distance);
    EXPECT_TRUE(std::isinf(tree.closest(p, i, 0.999 * least).distance));
  }
}

TEST(TriangleTree, SignOfABoxIsThatOfItsFormulaEverywhere) {
  const Vector3 half(0.02, 0.015, 0.01);
  const ClosedSurface surface = closed_surface(box_mesh(half, 3), "box");
  const TriangleTree tree(surface);
  std::mt19937 generator(2);
  for (int i = 0; i < 20000; ++i) {
    const Vector3 p = random_point(generator, 0.03);
    EXPECT_NEAR(tree.closest(p).distance, signed_distance(RoundedBox{half, 0.0}, p).distance,
                1e-12);
  }
}

TEST(TriangleTree, SignBesideSharpEdgesAndCorners) {
  // Nearest to an edge or a corner of 20 degrees, a face's own normal would often be wrong.
  const double angle = 20.0 * std::numbers::pi / 180.0;
  const ClosedSurface surface = closed_surface(wedge_mesh(angle, 0.01, 0.02), "wedge");
  const TriangleTree tree(surface);
  std::mt19937 generator(3);
  for (int i = 0; i < 20000; ++i) {
    const Vector3 p = random_point(generator, 0.025);
    const bool inside =
        p.z() > -0.01 && std::abs(p.y()) < 0.02 && std::abs(p.x()) < -p.z() * std::tan(0.5 * angle);
    EXPECT_EQ(tree.closest(p).distance < 0.0, inside) << p.transpose();
  }
}

TEST(TriangleTree, SignInATunnelAndATorus) {
  const ClosedSurface tunnel = closed_surface(tunnel_mesh(0.01, 0.004), "tunnel");
  const TriangleTree tunnel_tree(tunnel);
  const ClosedSurface torus = closed_surface(torus_mesh(0.02, 0.008, 120, 60), "torus");
  const TriangleTree torus_tree(torus);
  std::mt19937 generator(4);
  for (int i = 0; i < 20000; ++i) {
    const Vector3 p = random_point(generator, 0.012);
    const double across = std::max(std::abs(p.x()), std::abs(p.y()));
    const bool solid = across > 0.004 && across < 0.01 && std::abs(p.z()) < 0.01;
    EXPECT_EQ(tunnel_tree.closest(p).distance < 0.0, solid);
    const Vector3 q = 2.5 * p;
    const double exact = std::hypot(std::hypot(q.x(), q.y()) - 0.02, q.z()) - 0.008;
    // The facets' own error.
    EXPECT_NEAR(torus_tree.closest(q).distance, exact, 0.03e-3);
  }
}

TEST(TriangleTree, RefitKnowsWhatANewTreeWould) {
  ClosedSurface surface = closed_surface(torus_mesh(0.02, 0.008, 60, 30), "torus");
  TriangleTree tree(surface);
  for (Vector3& p : surface.mesh.positions) {
    p = Vector3(1.3 * p.x() + 0.01, p.y() + 0.2 * p.z(), 0.6 * p.z() + 2.0 * p.x() * p.x());
  }
  tree.refit();
  const TriangleTree anew(surface);
  std::mt19937 generator(2);
  for (int i = 0; i < 500; ++i) {
    const Vector3 p = random_point(generator, 0.04);
    const TriangleTree::Closest closest = tree.closest(p);
    const TriangleTree::Closest wanted = anew.closest(p);
    EXPECT_EQ(closest.distance, wanted.distance);
    EXPECT_LT((closest.point - wanted.point).norm(), 1e-15);
    const std::array<double, 3> weights{0.2, 0.5, 0.3};
    const Vector3 normal = tree.normal_at(closest.triangle, weights);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-14);
    EXPECT_LT((normal - anew.normal_at(closest.triangle, weights)).norm(), 1e-13);
  }
}

TEST(TriangleTree, FlatTrianglesChangeNothing) {
  // A vertex in the middle of an edge, spanned by a triangle without area.
  TriangleMesh mesh = box_mesh({0.01, 0.01, 0.01});
  const auto t = mesh.triangles.front();
  const auto middle = static_cast<int>(mesh.positions.size());
  mesh.positions.push_back(0.5 * (mesh.positions[static_cast<std::size_t>(t[0])] +
                                  mesh.positions[static_cast<std::size_t>(t[1])]));
  mesh.triangles.front() = {t[0], middle, t[2]};
  mesh.triangles.push_back({middle, t[1], t[2]});
  mesh.triangles.push_back({t[0], t[1], middle});
  const ClosedSurface surface = closed_surface(mesh, "box");
  const TriangleTree tree(surface);
  std::mt19937 generator(5);
  for (int i = 0; i < 5000; ++i) {
    const Vector3 p = random_point(generator, 0.02);
    EXPECT_NEAR(tree.closest(p).distance,
                signed_distance(RoundedBox{{0.01, 0.01, 0.01}, 0.0}, p).distance, 1e-12);
  }
}

}  // namespace
}  // namespace softfinger
