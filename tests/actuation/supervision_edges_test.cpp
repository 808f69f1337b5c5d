// Just when and just where supervision says something. Times are whole 64ths of a second, so that
// they are what they say to the last bit.
#include "softfinger/actuation/supervision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "../support/lever_platform.hpp"

namespace softfinger {
namespace {

constexpr double kMostError = 10.0 * deg;  ///< of the lever platform
constexpr double kLookTick = 1.0 / 64.0;

JointAngles three(double angle) { return JointAngles::Constant(3, angle); }

/// The first report at which somebody is named, of those at `time`; 0: none of some.
int report_that_names(Supervision& supervision, double time, const JointAngles& joints) {
  for (int report = 1; report <= 8; ++report) {
    if (supervision.seen(time, joints) != 0) return report;
  }
  return 0;
}

TEST(SupervisionEdges, ServosHaveHalfASecondAndThreeReports) {
  const auto device = lever_platform();
  for (const double begin : {0.0, 7.0}) {
    Supervision supervision(*device);
    supervision.sent(begin, three(0.0));
    EXPECT_EQ(report_that_names(supervision, begin + 0.5 - kLookTick, three(1.0)), 0);
    EXPECT_EQ(report_that_names(supervision, begin + 0.5, three(1.0)), 3);
    EXPECT_EQ(report_that_names(supervision, begin + 9.0, three(1.0)), 1) << "and is";
    EXPECT_EQ(report_that_names(supervision, begin + 9.0, three(0.0)), 0) << "it is back";
    EXPECT_EQ(report_that_names(supervision, begin + 9.0, three(1.0)), 3);
  }
}

TEST(SupervisionEdges, AnErrorThatIsAllowedIsNone) {
  const auto device = lever_platform();
  Supervision supervision(*device);
  supervision.sent(0.0, three(0.0));
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(report_that_names(supervision, 1.0, three(sign * kMostError)), 0);
    EXPECT_EQ(report_that_names(supervision, 1.0, three(sign * (kMostError + 1e-9))), 3);
    EXPECT_EQ(report_that_names(supervision, 1.0, three(0.0)), 0);
  }
}

TEST(SupervisionEdges, NamesEachServoByItsBitAndNoneThatIsNotThere) {
  const auto device = lever_platform();
  for (const int joints : {1, 3, kMostServos, kMostServos + 6}) {
    for (int astray = 0; astray < std::min<int>(joints, kMostServos); ++astray) {
      Supervision supervision(*device);
      JointAngles told = JointAngles::Zero(kMostServos + 6);
      JointAngles standing = JointAngles::Constant(kMostServos + 6, 9.0);  // what memory may hold
      told.conservativeResize(joints);
      standing.conservativeResize(joints);
      standing.setZero();
      standing[astray] = 1.0;
      supervision.sent(0.0, told);
      EXPECT_EQ(report_that_names(supervision, 1.0, standing), 3);
      EXPECT_EQ(supervision.seen(1.0, standing), 1U << astray) << joints;
    }
  }
}

// What was sent in the last half second is where a servo may be, and what was sent a little before
// that; what was sent long before is not.
TEST(SupervisionEdges, AServoMayBeWhereItWasSentInTheLastHalfSecond) {
  const auto device = lever_platform();
  std::mt19937 random(41);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int followed = 0;
  int strayed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Supervision supervision(*device);
    std::vector<double> told;
    double angle = 0.0;
    const int every = 1 + trial % 7;
    for (int k = 0; k < 400; ++k) {
      const double time = kLookTick * k;
      if (k % every == 0) {
        angle += 0.1 * uniform(random);
        supervision.sent(time, three(angle));
      }
      told.push_back(angle);
      if (time < 1.0 || k % 16 != 0) continue;
      const auto range_of = [&](double s) {
        const auto ticks = static_cast<std::ptrdiff_t>(s / kLookTick);
        return std::minmax_element(told.end() - 1 - ticks, told.end());
      };
      const auto [least, largest] = range_of(0.5);
      Supervision looks = supervision;
      EXPECT_EQ(report_that_names(looks, time, three(*least - kMostError + 1e-9)), 0);
      EXPECT_EQ(report_that_names(looks, time, three(*largest + kMostError - 1e-9)), 0);
      ++followed;
      // Five stretches of an eighth of a second, each as long as it takes until the next command.
      const auto [low, high] = range_of(std::min(time, 5.0 * (0.125 + kLookTick * every)));
      looks = supervision;
      EXPECT_EQ(report_that_names(looks, time, three(*low - kMostError - 1e-9)), 3);
      looks = supervision;
      EXPECT_EQ(report_that_names(looks, time, three(*high + kMostError + 1e-9)), 3);
      ++strayed;
    }
  }
  EXPECT_GT(followed, 500);
  EXPECT_GT(strayed, 500);
}

TEST(SupervisionEdges, AfterARestartWhatWasSentBeforeCountsNoMore) {
  const auto device = lever_platform();
  Supervision supervision(*device);
  for (int k = 0; k < 128; ++k) supervision.sent(kLookTick * k, three(1.0));
  EXPECT_EQ(report_that_names(supervision, 2.0, three(0.0)), 3);
  supervision.restart();
  EXPECT_EQ(report_that_names(supervision, 9.0, three(0.0)), 0) << "nothing was sent";
  supervision.sent(2.0, three(0.0));
  EXPECT_EQ(report_that_names(supervision, 2.5 - kLookTick, three(1.0)), 0);
  EXPECT_EQ(report_that_names(supervision, 2.5, three(1.0)), 3) << "where it was sent before";
}

TEST(SupervisionEdges, PressingIsTooLongJustAfterItsTimeAndAPauseIsHalfASecond) {
  const auto device = lever_platform({.press_time = 2.0});
  Supervision supervision(*device);
  EXPECT_FALSE(supervision.pressed_too_long(1.0, true));
  EXPECT_FALSE(supervision.pressed_too_long(3.0, true));
  EXPECT_TRUE(supervision.pressed_too_long(3.0 + kLookTick, true));
  EXPECT_TRUE(supervision.pressed_too_long(3.5, false)) << "a twitch is no pause";
  EXPECT_FALSE(supervision.pressed_too_long(3.5 + kLookTick, false));
  EXPECT_FALSE(supervision.pressed_too_long(4.0, true));
  EXPECT_FALSE(supervision.pressed_too_long(6.0, true));
  EXPECT_TRUE(supervision.pressed_too_long(6.0 + kLookTick, true));
  Supervision unlimited(*lever_platform());
  EXPECT_FALSE(unlimited.pressed_too_long(1.0, true));
  EXPECT_FALSE(unlimited.pressed_too_long(1e6, true)) << "of a device without such a limit";
}

}  // namespace
}  // namespace softfinger
