#include "softfinger/geometry/signed_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace softfinger {
namespace {

struct NamedShape {
  std::string name;
  Shape shape;
};

std::vector<NamedShape> all_shapes() {
  const Vector3 half(0.02, 0.015, 0.01);
  return {{"half_space", HalfSpace{}},
          {"ball", Ball{0.012}},
          {"box", RoundedBox{half, 0.002}},
          {"sharp_box", RoundedBox{half, 0.0}},
          {"pill_box", RoundedBox{half, 0.01}},
          {"cylinder", RoundedCylinder{0.01, 0.02, 0.001}},
          {"sharp_cylinder", RoundedCylinder{0.01, 0.02, 0.0}},
          {"capsule", RoundedCylinder{0.01, 0.02, 0.01}},
          {"puck", RoundedCylinder{0.02, 0.005, 0.005}},
          {"tapered_capsule", TaperedCapsule{0.011, 0.006, 0.015}},
          {"even_capsule", TaperedCapsule{0.008, 0.008, 0.012}}};
}

class EveryShape : public testing::TestWithParam<NamedShape> {};

// Central differences across a kink say nothing; a kink shows as a jump of the gradient.
bool smooth_near(const Shape& shape, const Vector3& p, double h) {
  const Vector3 g = signed_distance(shape, p).gradient;
  for (int i = 0; i < 3; ++i) {
    for (const double s : {-h, h}) {
      if ((signed_distance(shape, p + s * Vector3::Unit(i)).gradient - g).norm() > 0.02) {
        return false;
      }
    }
  }
  return true;
}

TEST_P(EveryShape, GradientIsTheDerivative) {
  const Shape& shape = GetParam().shape;
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> coordinate(-0.03, 0.03);
  const double h = 1e-6;
  int checked = 0;
  for (int k = 0; k < 10000; ++k) {
    const Vector3 p(coordinate(generator), coordinate(generator), coordinate(generator));
    const SignedDistance at = signed_distance(shape, p);
    ASSERT_NEAR(at.gradient.norm(), 1.0, 1e-12);
    if (!smooth_near(shape, p, 2 * h)) continue;
    ++checked;
    for (int i = 0; i < 3; ++i) {
      const double plus = signed_distance(shape, p + h * Vector3::Unit(i)).distance;
      const double minus = signed_distance(shape, p - h * Vector3::Unit(i)).distance;
      ASSERT_NEAR((plus - minus) / (2 * h), at.gradient[i], 1e-4) << p.transpose();
    }
  }
  EXPECT_GT(checked, 9900);
}

// The second derivative jumps where a face meets its rounding, and medial sets have none; random
// points next to those are rare.
TEST_P(EveryShape, HessianIsTheDerivativeOfTheGradient) {
  const Shape& shape = GetParam().shape;
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> coordinate(-0.03, 0.03);
  const double h = 1e-7;
  int wrong = 0;
  for (int k = 0; k < 10000; ++k) {
    const Vector3 p(coordinate(generator), coordinate(generator), coordinate(generator));
    const SignedDistance at = signed_distance(shape, p);
    ASSERT_LT((at.hessian - at.hessian.transpose()).norm(), 1e-9);
    ASSERT_LT((at.hessian * at.gradient).norm(), 1e-12 * (1.0 + at.hessian.norm()));  // eikonal
    Matrix3 difference;
    for (int i = 0; i < 3; ++i) {
      const Vector3 plus = signed_distance(shape, p + h * Vector3::Unit(i)).gradient;
      const Vector3 minus = signed_distance(shape, p - h * Vector3::Unit(i)).gradient;
      difference.col(i) = (plus - minus) / (2 * h);
    }
    if ((difference - at.hessian).norm() > 1e-4 * (1.0 + at.hessian.norm())) ++wrong;
  }
  EXPECT_LE(wrong, 10);
}

// No other point of the ball of radius |d| about p is on the other side of the surface, and the
// foot point p - d n is on it: together they say that the distance is exact.
TEST_P(EveryShape, FootPointLiesOnTheSurface) {
  const Shape& shape = GetParam().shape;
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> coordinate(-0.03, 0.03);
  for (int k = 0; k < 5000; ++k) {
    const Vector3 p(coordinate(generator), coordinate(generator), coordinate(generator));
    const Vector3 other(coordinate(generator), coordinate(generator), coordinate(generator));
    const SignedDistance at = signed_distance(shape, p);
    EXPECT_NEAR(signed_distance(shape, p - at.distance * at.gradient).distance, 0.0, 1e-12);
    // Lipschitz with constant 1.
    EXPECT_LE(std::abs(at.distance - signed_distance(shape, other).distance),
              (p - other).norm() + 1e-12);
  }
}

TEST_P(EveryShape, IsFiniteAtSpecialPoints) {
  const Shape& shape = GetParam().shape;
  for (const double x : {0.0, -0.0, 0.01, 0.02, 1e-200, 1e-13}) {
    for (const double y : {0.0, 0.015, -1e-13}) {
      for (const double z : {0.0, 0.01, -0.02, 0.1, 1e-300}) {
        const SignedDistance at = signed_distance(shape, {x, y, z});
        EXPECT_TRUE(std::isfinite(at.distance));
        EXPECT_NEAR(at.gradient.norm(), 1.0, 1e-12);
        EXPECT_TRUE(at.hessian.allFinite());
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SignedDistance, EveryShape, testing::ValuesIn(all_shapes()),
                         [](const auto& test) { return test.param.name; });

TEST(SignedDistance, ClosedForms) {
  EXPECT_DOUBLE_EQ(signed_distance(HalfSpace{}, {1.0, 2.0, -0.3}).distance, -0.3);
  EXPECT_NEAR(signed_distance(Ball{2.0}, {2.0, 3.0, 6.0}).distance, 5.0, 1e-15);
  const RoundedBox box{{1.0, 2.0, 3.0}, 0.25};
  EXPECT_NEAR(signed_distance(box, {1.5, 0.0, 0.0}).distance, 0.5, 1e-15);
  EXPECT_NEAR(signed_distance(box, {0.9, 0.1, 0.2}).distance, -0.1, 1e-15);
  EXPECT_NEAR(signed_distance(box, {0.0, 0.0, 0.0}).distance, -1.0, 1e-15);
  // The corner of the sharp box is cut by (sqrt(3) - 1) r.
  EXPECT_NEAR(signed_distance(box, {-1.0, 2.0, -3.0}).distance, (std::sqrt(3.0) - 1.0) * 0.25,
              1e-15);
  EXPECT_LT((signed_distance(box, {1.0, 2.0, 0.0}).gradient - Vector3(1, 1, 0).normalized()).norm(),
            1e-15);
  const RoundedCylinder cylinder{1.0, 2.0, 0.25};
  EXPECT_NEAR(signed_distance(cylinder, {3.0, 4.0, 0.5}).distance, 4.0, 1e-15);
  EXPECT_NEAR(signed_distance(cylinder, {0.1, 0.0, -1.8}).distance, -0.2, 1e-15);
  EXPECT_NEAR(signed_distance(cylinder, {0.6, 0.8, 2.0}).distance, (std::sqrt(2.0) - 1.0) * 0.25,
              1e-15);
}

// What Newton relies on: walking through a rounded edge, the gradient changes no faster than the
// walk divided by the distance to the inner edge.
TEST(SignedDistance, GradientIsContinuousAcrossFaceEdgeAndFlank) {
  const std::vector<Shape> shapes{RoundedBox{{0.02, 0.02, 0.02}, 0.001},
                                  RoundedCylinder{0.02, 0.02, 0.001}};
  for (const Shape& shape : shapes) {
    const double step = 1e-6;
    for (const double depth : {-0.0005, 0.0, 0.0008}) {
      Vector3 last = Vector3::Zero();
      const double reach = 0.001 + depth;
      for (double s = -0.002; s < 0.002; s += step) {
        // A path at the constant distance `depth` from the surface.
        const double arc = std::numbers::pi / 2 * reach;
        Vector3 p;
        if (s < 0) {
          p = {0.019 + s, 0.0, 0.019 + reach};
        } else if (s < arc) {
          p = {0.019 + reach * std::sin(s / reach), 0.0, 0.019 + reach * std::cos(s / reach)};
        } else {
          p = {0.019 + reach, 0.0, 0.019 - (s - arc)};
        }
        const SignedDistance at = signed_distance(shape, p);
        EXPECT_NEAR(at.distance, depth, 1e-12);
        if (!last.isZero()) {
          EXPECT_LT((at.gradient - last).norm(), 1.01 * step / reach);
        }
        last = at.gradient;
      }
    }
  }
}

}  // namespace
}  // namespace softfinger
