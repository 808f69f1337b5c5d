#include "softfinger/motors/servo_map.hpp"

#include <gtest/gtest.h>

#include <random>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

const ServoSettings kPlain{.channel = 0,
                           .zero = 1500 * us,
                           .per_radian = 10 * us / deg,
                           .min = 800 * us,
                           .max = 2400 * us};

TEST(ServoMap, FollowsTheDeviceFile) {
  const ServoMap map(kPlain);
  EXPECT_NEAR(map.setpoint(0.0), 1500 * us, 1e-12);
  EXPECT_NEAR(map.setpoint(30.0 * deg), 1800 * us, 1e-12);
  EXPECT_NEAR(map.setpoint(-90.0 * deg), 800 * us, 1e-12);
  EXPECT_NEAR(map.setpoint(120.0 * deg), 2400 * us, 1e-12);
  EXPECT_EQ(map.target(0.0, -20 * deg, 90 * deg), 6000);
  EXPECT_EQ(map.target(30.0 * deg, -20 * deg, 90 * deg), 7200);
  EXPECT_EQ(map.target(90.0 * deg, -20 * deg, 90 * deg), 9600);
}

TEST(ServoMap, GoesThereAndBack) {
  ServoSettings reversed = kPlain;
  reversed.per_radian = -reversed.per_radian;
  for (const ServoSettings& settings : {kPlain, reversed}) {
    const ServoMap map(settings);
    for (double joint = -60 * deg; joint < 60 * deg; joint += 0.7 * deg) {
      EXPECT_NEAR(map.joint(map.setpoint(joint)), joint, 1e-12);
      const auto target = map.target(joint, -60 * deg, 60 * deg);
      EXPECT_NEAR(map.joint_of_target(target), joint, 0.51 * map.resolution());
    }
  }
}

TEST(ServoMap, RoundingStaysWithinLimits) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    ServoSettings settings = kPlain;
    settings.zero += 100 * us * uniform(random);
    settings.per_radian *= uniform(random) < 0.0 ? -0.77 : 1.03;
    const ServoMap map(settings);
    const double low = -20 * deg + 0.5 * deg * uniform(random);
    const double high = 40 * deg + 0.5 * deg * uniform(random);
    const double joint = map.joint_of_target(map.target(2.0 * uniform(random), low, high));
    EXPECT_GE(joint, low - 1e-7);
    EXPECT_LE(joint, high + 1e-7);
  }
}

}  // namespace
}  // namespace softfinger
