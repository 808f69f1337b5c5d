#include "softfinger/actuation/joint_ramp.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "../support/lever_platform.hpp"

namespace softfinger {
namespace {

constexpr double kRampTick = 1.0 / 30.0;
constexpr double kRampRate = 400.0 * deg;              ///< of the lever platform
constexpr double kRampAcceleration = kRampRate / 0.1;  ///< three ticks to full speed

class JointRampOfLevers : public testing::Test {
 protected:
  JointRampOfLevers() : ramp(device, maps) {
    EXPECT_TRUE(device->inverse_kinematics(device->retracted(), retracted));
  }

  static std::vector<ServoMap> maps_of(const Device& device) {
    std::vector<ServoMap> maps;
    for (const ServoSettings& servo : device.settings().transport->servos) maps.emplace_back(servo);
    return maps;
  }

  std::shared_ptr<const Device> device = lever_platform({.acceleration = kRampAcceleration});
  std::vector<ServoMap> maps = maps_of(*device);
  JointRamp ramp;
  JointAngles retracted;
};

TEST_F(JointRampOfLevers, IsRetractedUntilItStarts) {
  EXPECT_FALSE(ramp.is_under_way());
  EXPECT_TRUE(ramp.arrived());
  EXPECT_EQ(ramp.joints(), retracted);
}

TEST_F(JointRampOfLevers, StandsWhereItStartsUntilItSteps) {
  const JointAngles standing = retracted.array() + 50.0 * deg;
  ramp.start(standing);
  EXPECT_TRUE(ramp.is_under_way());
  EXPECT_FALSE(ramp.arrived());
  EXPECT_EQ(ramp.joints(), standing);
  ASSERT_EQ(ramp.targets().size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(maps[i].joint_of_target(ramp.targets()[i]), standing[Eigen::Index(i)],
                0.51 * maps[i].resolution());
  }
  ramp.end();
  EXPECT_FALSE(ramp.is_under_way());
}

TEST_F(JointRampOfLevers, GainsSpeedAsItMayUpToTheRateLimit) {
  ramp.start(retracted.array() + 80.0 * deg);
  double travelled = 0.0;
  for (int k = 1; k <= 5; ++k) {
    ramp.step(kRampTick);
    travelled += std::min(kRampRate, k * kRampAcceleration * kRampTick) * kRampTick;
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(ramp.joints()[i], retracted[i] + 80.0 * deg - travelled, 1e-12) << k;
    }
  }
}

TEST_F(JointRampOfLevers, StartsFromRestEachTime) {
  ramp.start(retracted.array() + 80.0 * deg);
  for (int k = 0; k < 4; ++k) ramp.step(kRampTick);
  ramp.start(retracted.array() + 80.0 * deg);
  ramp.step(kRampTick);
  EXPECT_NEAR(ramp.joints()[0],
              retracted[0] + 80.0 * deg - kRampAcceleration * kRampTick * kRampTick, 1e-12);
}

TEST_F(JointRampOfLevers, EachJointGoesItsOwnWayAndStaysWhereItIsRetracted) {
  JointAngles standing = retracted;
  standing[0] += 30.0 * deg;
  standing[1] -= 10.0 * deg;
  ramp.start(standing);
  JointAngles before = standing;
  int ticks = 0;
  while (!ramp.arrived()) {
    ramp.step(kRampTick);
    ASSERT_LT(++ticks, 10);
    for (int i = 0; i < 3; ++i) {
      EXPECT_LE(std::abs(ramp.joints()[i] - retracted[i]), std::abs(before[i] - retracted[i]));
      EXPECT_LE(std::abs(ramp.joints()[i] - before[i]), kRampRate * kRampTick + 1e-12);
      EXPECT_NEAR(maps[std::size_t(i)].joint_of_target(ramp.targets()[std::size_t(i)]),
                  ramp.joints()[i], 0.51 * maps[std::size_t(i)].resolution());
    }
    before = ramp.joints();
  }
  EXPECT_EQ(ramp.joints(), retracted);
  // 30 degrees: 4.4, 8.9 and 13.3 of them, and the rest.
  EXPECT_EQ(ticks, 4);
}

// Outside of its limits a joint may stand, but is never sent further out.
TEST_F(JointRampOfLevers, FromOutsideOfTheLimitsItOnlyComesIn) {
  for (const double outside : {-30.0 * deg, 99.0 * deg}) {
    ramp.start(JointAngles::Constant(3, outside));
    int ticks = 0;
    do {
      for (std::size_t i = 0; i < 3; ++i) {
        const double sent = maps[i].joint_of_target(ramp.targets()[i]);
        EXPECT_GE(sent, std::min(outside, -20.0 * deg) - 1e-7);
        EXPECT_LE(sent, std::max(outside, 90.0 * deg) + 1e-7);
        EXPECT_NEAR(sent, ramp.joints()[Eigen::Index(i)], 1.01 * maps[i].resolution())
            << "cut at the joint's limit";
      }
      ramp.step(kRampTick);
      ASSERT_LT(++ticks, 30);
    } while (!ramp.arrived());
  }
}

TEST_F(JointRampOfLevers, NoTimeIsNoMotion) {
  const JointAngles standing = retracted.array() + 5.0 * deg;
  ramp.start(standing);
  ramp.step(0.0);
  EXPECT_EQ(ramp.joints(), standing);
}

}  // namespace
}  // namespace softfinger
