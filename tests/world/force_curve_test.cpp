#include "softfinger/world/force_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace softfinger {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Of a button, in mm and N.
const JointCurve kDome{{0.0, 1.0, 1.4, 2.5}, {0.0, 1.2, 0.7, 2.5}};

TEST(ForceCurve, IsWhatThePapersFormulasGive) {
  // By hand: slopes 0, 1.5, 3.75, 6 and a half of each side plus an eighth of their difference.
  const ForceCurve even({{0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 4.0, 9.0}});
  EXPECT_NEAR(even.at(0.5).force, 0.3125, 1e-14);
  EXPECT_NEAR(even.at(1.5).force, 2.21875, 1e-14);
  EXPECT_NEAR(even.at(2.5).force, 6.21875, 1e-14);
  // Slopes 2.5, 6/7, 0: the last one would fall.
  const ForceCurve uneven({{0.0, 1.0, 3.0}, {0.0, 2.0, 3.0}});
  EXPECT_NEAR(uneven.at(0.0).slope, 2.5, 1e-14);
  EXPECT_NEAR(uneven.at(0.5).force, 1.0 + (2.5 - 6.0 / 7.0) / 8.0, 1e-14);
  EXPECT_NEAR(uneven.at(2.0).force, 2.5 + 2.0 * 6.0 / 7.0 / 8.0, 1e-14);
  EXPECT_NEAR(uneven.at(3.0).slope, 0.0, 1e-14);
  // Its first slope would be more than three times its first chord.
  const ForceCurve steep({{0.0, 1.0, 2.0}, {0.0, 1.0, -9.0}});
  EXPECT_NEAR(steep.at(0.0).slope, 3.0, 1e-14);
}

TEST(ForceCurve, GoesThroughItsPointsAndNoFurtherBetweenThem) {
  const ForceCurve curve(kDome);
  for (std::size_t i = 0; i < kDome.travel.size(); ++i) {
    EXPECT_NEAR(curve.at(kDome.travel[i]).force, kDome.force[i], 1e-14);
  }
  for (std::size_t i = 0; i + 1 < kDome.travel.size(); ++i) {
    const double sign = kDome.force[i + 1] > kDome.force[i] ? 1.0 : -1.0;
    for (double part = 0.01; part < 1.0; part += 0.01) {
      const double travel = kDome.travel[i] + part * (kDome.travel[i + 1] - kDome.travel[i]);
      EXPECT_GT(sign * curve.at(travel).slope, 0.0) << travel;
    }
  }
}

TEST(ForceCurve, WorkIsTheIntegralOfForceAndSlopeItsDerivative) {
  const ForceCurve curve({{0.3, 1.0, 1.4, 2.5}, {0.2, 1.2, 0.7, 2.5}});
  EXPECT_EQ(curve.at(0.0).work, 0.0);
  const int parts = 40000;  // and points of the curve between them
  const double length = 4.0 / parts;
  double work = 0.0;
  for (int i = 0; i < parts; ++i) {
    work += length * curve.at((i + 0.5) * length).force;
    if (i % 1000 != 999) continue;
    const double travel = (i + 1) * length;
    EXPECT_NEAR(curve.at(travel).work, work, 1e-8) << travel;
    const double step = 1e-6;
    const double slope = (curve.at(travel + step).force - curve.at(travel - step).force) / 2e-6;
    EXPECT_NEAR(curve.at(travel).slope, slope, 1e-4) << travel;
  }
}

TEST(ForceCurve, GoesOnWithItsEndSlopes) {
  const ForceCurve curve(kDome);
  EXPECT_NEAR(curve.at(-2.0).force, -2.0 * curve.at(0.0).slope, 1e-14);
  EXPECT_NEAR(curve.at(3.5).force, 2.5 + curve.at(2.5).slope, 1e-14);
  const ForceCurve line({{1.0, 2.0}, {3.0, 5.0}});
  for (const double travel : {-1.0, 1.5, 7.0}) {
    EXPECT_NEAR(line.at(travel).force, 1.0 + 2.0 * travel, 1e-14);
    EXPECT_NEAR(line.at(travel).work, travel + travel * travel, 1e-13);
  }
}

TEST(ForceCurve, LeastSlopeIsThatOfASearch) {
  const ForceCurve curve(kDome);
  for (const auto& [from, to] : {std::pair{-1.0, 3.0}, std::pair{0.2, 1.1}, std::pair{1.3, 1.35},
                                 std::pair{2.4, 9.0}, std::pair{-kNever, kNever}}) {
    double least = kNever;
    for (double x = std::max(from, -1.0); x <= std::min(to, 9.0); x += 1e-4) {
      least = std::min(least, curve.at(x).slope);
    }
    EXPECT_NEAR(curve.least_slope(from, to), least, 1e-2) << from;
    EXPECT_LE(curve.least_slope(from, to), least + 1e-12) << from;
  }
}

TEST(ForceCurve, KnowsWhereItSnaps) {
  const ForceCurve dome(kDome);
  ASSERT_EQ(dome.snaps().size(), 1U);
  EXPECT_EQ(dome.snaps()[0].top, 1.0);
  EXPECT_EQ(dome.snaps()[0].valley, 1.4);
  // Of a shutter: two stages, level parts beside the first, the second without an end.
  const ForceCurve two({{0, 1, 2, 3, 4, 5, 6}, {0, 2, 2, 1, 1, 3, 2}});
  ASSERT_EQ(two.snaps().size(), 2U);
  EXPECT_EQ(two.snaps()[0].top, 2.0);
  EXPECT_EQ(two.snaps()[0].valley, 4.0);
  EXPECT_EQ(two.snaps()[1].top, 5.0);
  EXPECT_EQ(two.snaps()[1].valley, kNever);
  EXPECT_TRUE(ForceCurve({{0, 1, 2}, {0, 1, 1}}).snaps().empty());
  EXPECT_TRUE(ForceCurve({{0, 1, 2}, {2, 1, 3}}).snaps().empty());
}

}  // namespace
}  // namespace softfinger
