#include "softfinger/geometry/signed_distance_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "generated_mesh.hpp"
#include "softfinger/geometry/grid_sampling.hpp"

namespace softfinger {
namespace {

constexpr double mm = 1e-3;
constexpr double um = 1e-6;

struct Solid {
  explicit Solid(TriangleMesh mesh, double spacing = 0.25 * mm)
      : surface(closed_surface(std::move(mesh), "mesh")),
        tree(surface),
        grid(sample_distance(surface, tree, spacing, 6.0 * mm, "mesh"), "mesh", 0) {}

  ClosedSurface surface;
  TriangleTree tree;
  SignedDistanceGrid grid;
};

const Solid& sphere() {
  static const Solid solid(sphere_mesh(8.0 * mm, 120));
  return solid;
}
const Solid& torus() {
  static const Solid solid(torus_mesh(9.0 * mm, 4.0 * mm, 600, 300));
  return solid;
}
const Solid& tunnel() {
  static const Solid solid(tunnel_mesh(6.0 * mm, 2.5 * mm), 0.5 * mm);
  return solid;
}

std::vector<Vector3> points(const Solid& solid, int count, double beyond) {
  std::mt19937 generator(1);
  const Eigen::AlignedBox3d& bounds = solid.grid.content().bounds;
  std::uniform_real_distribution<double> x(0.0, 1.0);
  std::vector<Vector3> drawn;
  for (int i = 0; i < count; ++i) {
    const Vector3 at(x(generator), x(generator), x(generator));
    drawn.push_back(bounds.min() - Vector3::Constant(beyond) +
                    at.cwiseProduct(bounds.sizes() + Vector3::Constant(2.0 * beyond)));
  }
  return drawn;
}

/// On a fine mesh of a smooth solid the grid is within half a micrometre of the exact distance.
TEST(SignedDistanceGrid, SmoothSurfacesWithinHalfAMicrometre) {
  for (const Solid* solid : {&sphere(), &torus()}) {
    double worst = 0.0;
    int near = 0;
    for (const Vector3& p : points(*solid, 30000, 1.0 * mm)) {
      const double exact = solid->tree.closest(p).distance;
      const double error = std::abs(solid->grid.signed_distance(p).distance - exact);
      if (std::abs(exact) < 1.5 * mm) {
        EXPECT_LT(error, 0.5 * um + 5e-3 * std::abs(exact));
      }
      if (std::abs(exact) > 0.5 * mm) continue;
      ++near;
      worst = std::max(worst, error);
    }
    RecordProperty(solid == &sphere() ? "sphere_um" : "torus_um", std::to_string(worst / um));
    EXPECT_GT(near, 3000);
    EXPECT_LT(worst, 0.5 * um);
  }
}

TEST(SignedDistanceGrid, AgreesWithTheFormulaOfATorus) {
  for (const Vector3& p : points(torus(), 50000, 1.0 * mm)) {
    const double exact = std::hypot(std::hypot(p.x(), p.y()) - 9.0 * mm, p.z()) - 4.0 * mm;
    const double distance = torus().grid.signed_distance(p).distance;
    // The facets lie up to 2 um inside.
    if (std::abs(exact) < 1.0 * mm) {
      EXPECT_NEAR(distance, exact, 3.0 * um);
    }
    if (std::abs(exact) > 5.0 * um) {
      EXPECT_EQ(distance < 0.0, exact < 0.0);
    }
  }
}

TEST(SignedDistanceGrid, SignIsExactAwayFromTheRounding) {
  int compared[2] = {};
  for (const Vector3& p : points(tunnel(), 50000, 3.0 * mm)) {
    const double exact = tunnel().tree.closest(p).distance;
    if (std::abs(exact) < 0.3 * mm) continue;
    EXPECT_EQ(tunnel().grid.signed_distance(p).distance < 0.0, exact < 0.0);
    ++compared[exact < 0.0 ? 0 : 1];
  }
  EXPECT_GT(compared[0], 1000);
  EXPECT_GT(compared[1], 1000);
}

TEST(SignedDistanceGrid, DerivativesAreThoseOfTheValue) {
  const double h = 1e-7;
  for (const Solid* solid : {&torus(), &tunnel()}) {
    int in_domain = 0;
    for (const Vector3& p : points(*solid, 5000, 8.0 * mm)) {  // up to 2 mm outside the domain
      const SignedDistance at = solid->grid.signed_distance(p);
      const SignedDistance first = solid->grid.distance_and_gradient(p);
      EXPECT_EQ(first.distance, at.distance);
      EXPECT_EQ(first.gradient, at.gradient);
      for (int i = 0; i < 3; ++i) {
        const SignedDistance plus = solid->grid.signed_distance(p + h * Vector3::Unit(i));
        const SignedDistance minus = solid->grid.signed_distance(p - h * Vector3::Unit(i));
        EXPECT_NEAR(at.gradient[i], (plus.distance - minus.distance) / (2.0 * h), 1e-6);
        if (!solid->grid.content().domain.contains(p)) continue;
        ++in_domain;
        const Vector3 change = (plus.gradient - minus.gradient) / (2.0 * h);
        EXPECT_LT((at.hessian.col(i) - change).norm(), 0.02 + 1e-3 * at.hessian.norm());
      }
    }
    EXPECT_GT(in_domain, 1000);
  }
}

/// Straight through blocks, bands and cells of all levels: neither value nor gradient ever jumps.
TEST(SignedDistanceGrid, GradientIsContinuousAcrossCellsAndBands) {
  const double step = 1.0 * um;
  for (const Vector3& direction :
       {Vector3(1, 0, 0), Vector3(0.6, 0.64, 0.48), Vector3(0, 0.1, 1)}) {
    const Vector3 along = direction.normalized();
    SignedDistance last = tunnel().grid.signed_distance(-11.0 * mm * along);
    for (double s = -11.0 * mm; s < 11.0 * mm; s += step) {
      const SignedDistance at = tunnel().grid.signed_distance(s * along);
      EXPECT_LT(std::abs(at.distance - last.distance), 1.5 * step);
      // Curvature is at most some 5 / spacing.
      EXPECT_LT((at.gradient - last.gradient).norm(), 5.0 / (0.5 * mm) * step) << s;
      last = at;
    }
  }
}

/// Deeper than the finest band a gradient still leads out.
TEST(SignedDistanceGrid, PushesOutFromDeepInside) {
  int inside = 0;
  for (const Vector3& p : points(sphere(), 20000, 0.0)) {
    const double depth = 8.0 * mm - p.norm();
    if (depth < 5.0 * um || depth > 6.0 * mm) continue;  // facets lie a little inside
    const SignedDistance at = sphere().grid.signed_distance(p);
    EXPECT_LT(at.distance, 0.0);
    EXPECT_GT(at.gradient.dot(p.normalized()), 0.95);
    ++inside;
  }
  EXPECT_GT(inside, 1000);
}

TEST(SignedDistanceGrid, FarDistanceIsNeverTooLarge) {
  int far = 0;
  for (const Vector3& p : points(sphere(), 20000, 60.0 * mm)) {
    const double exact = p.norm() - 8.0 * mm;
    if (exact < 6.0 * mm) continue;
    const double distance = sphere().grid.signed_distance(p).distance;
    EXPECT_LT(distance, 1.02 * exact);
    EXPECT_GT(distance, 0.5 * exact);
    ++far;
  }
  EXPECT_GT(far, 10000);
  // Continuous where the domain ends.
  const Eigen::AlignedBox3d& domain = sphere().grid.content().domain;
  Vector3 border(1.0 * mm, 2.0 * mm, domain.max().z());
  const double inside = sphere().grid.signed_distance(border).distance;
  border.z() += 1e-12;
  EXPECT_NEAR(sphere().grid.signed_distance(border).distance, inside, 1e-10);
}

/// An edge is rounded by no more than its radius: the rounded edge lies between the sharp one and
/// the arc of that radius that touches both faces.
class Wedge : public testing::TestWithParam<int> {};

TEST_P(Wedge, IsRoundedByAtMostTheRadius) {
  const double radius = 0.25 * mm;
  const double angle = GetParam() * std::numbers::pi / 180.0;
  const double arc = radius * (1.0 / std::sin(0.5 * angle) - 1.0);
  // Several places relative to the grid's cells.
  for (int k = 0; k < 4; ++k) {
    const Pose X{exp_rotation(Vector3(0.3 * k, 0.2 * k, 0.1 * k)),
                 Vector3(0.07, 0.03, 0.05) * k * mm};
    const Solid wedge(moved(wedge_mesh(angle, 4.0 * mm, 4.0 * mm), X), 0.5 * radius);
    double low = -3.0 * mm;
    double high = 1.0 * mm;
    while (high - low > 0.01 * um) {
      const double z = 0.5 * (low + high);
      const Vector3 p = X * Vector3(0.0, 0.0, z);
      (wedge.grid.signed_distance(p).distance < 0.0 ? low : high) = z;
    }
    EXPECT_LT(high, 0.1 * arc) << k;
    EXPECT_GT(high, -arc) << k;
    RecordProperty("recession_um_" + std::to_string(k), std::to_string(-high / um));
  }
}

INSTANTIATE_TEST_SUITE_P(SignedDistanceGrid, Wedge, testing::Values(20, 40, 60, 90, 120, 140));

TEST(SignedDistanceGrid, TurnsWithItsObject) {
  const Pose X{exp_rotation(Vector3(0.5, -0.3, 0.9)), Vector3(1, 2, 3) * mm};
  const TriangleMesh mesh = torus_mesh(9.0 * mm, 4.0 * mm, 360, 160);
  const Solid here(mesh);
  const Solid there(moved(mesh, X));
  int near = 0;
  for (const Vector3& p : points(here, 5000, 1.0 * mm)) {
    const SignedDistance a = here.grid.signed_distance(p);
    const SignedDistance b = there.grid.signed_distance(X * p);
    if (std::abs(a.distance) > 1.0 * mm) continue;
    EXPECT_NEAR(a.distance, b.distance, 3.0 * um);
    EXPECT_LT((X.rotation * a.gradient - b.gradient).norm(), 0.02);
    ++near;
  }
  EXPECT_GT(near, 1000);
}

TEST(SignedDistanceGrid, IsTheSameEachTime) {
  const TriangleMesh mesh = torus_mesh(9.0 * mm, 4.0 * mm, 72, 32);
  const Solid first(mesh);
  const Solid second(mesh);
  ASSERT_EQ(first.grid.content().levels.size(), second.grid.content().levels.size());
  for (std::size_t l = 0; l < first.grid.content().levels.size(); ++l) {
    EXPECT_EQ(first.grid.content().levels[l].index, second.grid.content().levels[l].index);
    EXPECT_EQ(first.grid.content().levels[l].coefficients,
              second.grid.content().levels[l].coefficients);
  }
}

}  // namespace
}  // namespace softfinger
