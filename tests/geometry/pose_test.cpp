#include "softfinger/geometry/pose.hpp"

#include <gtest/gtest.h>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

const Pose kFrom{exp_rotation({0.3, -0.2, 1.1}), {0.01, -0.02, 0.03}};
const Pose kTo{exp_rotation({-0.4, 0.5, 0.2}), {-0.02, 0.01, 0.05}};

double turn_between(const Pose& a, const Pose& b) {
  return log_rotation(a.rotation.transpose() * b.rotation).norm();
}
double way_between(const Pose& a, const Pose& b) { return (a.translation - b.translation).norm(); }

TEST(Interpolate, GoesStraightAtAnEvenPace) {
  const double way = way_between(kFrom, kTo);
  const double turn = turn_between(kFrom, kTo);
  for (const double fraction : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    const Pose pose = interpolate(kFrom, kTo, fraction);
    EXPECT_NEAR(way_between(kFrom, pose), fraction * way, 1e-15) << fraction;
    EXPECT_NEAR(way_between(pose, kTo), (1.0 - fraction) * way, 1e-15) << fraction;
    EXPECT_NEAR(turn_between(kFrom, pose), fraction * turn, 1e-14) << fraction;
    EXPECT_NEAR(turn_between(pose, kTo), (1.0 - fraction) * turn, 1e-14) << fraction;
  }
}

TEST(Interpolate, IsTheSameFromBothEnds) {
  const Pose pose = interpolate(kFrom, kTo, 0.3);
  const Pose back = interpolate(kTo, kFrom, 0.7);
  EXPECT_LT(way_between(pose, back), 1e-15);
  EXPECT_LT(turn_between(pose, back), 1e-14);
}

TEST(Interpolate, RestsWherePosesAreOne) {
  const Pose pose = interpolate(kFrom, kFrom, 0.37);
  EXPECT_EQ(pose.translation, kFrom.translation);
  EXPECT_LT(turn_between(pose, kFrom), 1e-15);
}

TEST(MovedTowards, IsBoundedInWayAndTurnOneByOne) {
  const double way = way_between(kFrom, kTo);
  const double turn = turn_between(kFrom, kTo);
  const Pose pose = moved_towards(kFrom, kTo, 0.25 * way, 0.6 * turn);
  EXPECT_LT(way_between(pose, interpolate(kFrom, kTo, 0.25)), 1e-15);
  EXPECT_LT(turn_between(pose, interpolate(kFrom, kTo, 0.6)), 1e-14);
}

TEST(MovedTowards, ArrivesToTheBit) {
  const Pose pose = moved_towards(kFrom, kTo, 1.0, 180.0 * deg);
  EXPECT_EQ(pose.translation, kTo.translation);
  EXPECT_EQ(pose.rotation, kTo.rotation);
  const Pose turned = moved_towards(kFrom, kTo, 0.0, 180.0 * deg);
  EXPECT_EQ(turned.translation, kFrom.translation);
  EXPECT_EQ(turned.rotation, kTo.rotation);
}

}  // namespace
}  // namespace softfinger
