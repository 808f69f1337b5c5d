#include <gtest/gtest.h>

#include "softfinger/actuation/servo_lag.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

// On either side of zero, and either way.
TEST(ServoLagEdges, IsToldOfEveryMotionWhereverItIs) {
  for (const double begin : {-2.0, -0.05, 2.0}) {
    for (const double speed : {0.5, -0.5}) {
      const auto motion = [&](double time) { return JointAngles{{begin + speed * time}}; };
      ServoLag lags(1, 1.0 * deg);
      const double time = 0.39;
      for (int k = 0; k < 40; ++k) lags.sent(0.01 * k, motion(0.01 * k));
      const auto seen = lags.seen(time, motion(time - 0.05));
      ASSERT_TRUE(seen) << begin << ' ' << speed;
      EXPECT_NEAR(*seen, 0.05, 1e-9);
      EXPECT_FALSE(lags.seen(time, motion(time + 0.001)));
    }
  }
}

// What is asked later than it was sent has waited as long besides.
TEST(ServoLagEdges, CountsFromWhenTheServosAreSeen) {
  ServoLag lags(1, 1.0 * deg);
  for (int k = 0; k < 20; ++k) lags.sent(0.01 * k, JointAngles{{0.01 * k}});
  const auto seen = lags.seen(0.2, JointAngles{{0.19}});
  ASSERT_TRUE(seen) << "all the way";
  EXPECT_NEAR(*seen, 0.01, 1e-9);
}

TEST(ServoLagEdges, ServosSeenBeforeTheyWereSentThereHaveNoLag) {
  ServoLag lags(1, 1.0 * deg);
  for (int k = 0; k < 20; ++k) lags.sent(0.01 * k, JointAngles{{0.01 * k}});
  EXPECT_FALSE(lags.seen(0.1, JointAngles{{0.15}}));
  EXPECT_TRUE(lags.seen(0.15, JointAngles{{0.15}}));
}

TEST(ServoLagEdges, TheJointThatMovesMostIsLookedAt) {
  ServoLag lags(2, 1.0 * deg);
  for (int k = 0; k < 20; ++k) lags.sent(0.01 * k, JointAngles{{0.01 * k, -0.02 * k}});
  // The first is 0.1 s behind, the second 0.05 s.
  const auto seen = lags.seen(0.19, JointAngles{{0.09, -0.28}});
  ASSERT_TRUE(seen);
  EXPECT_NEAR(*seen, 0.05, 1e-9);
}

}  // namespace
}  // namespace softfinger
