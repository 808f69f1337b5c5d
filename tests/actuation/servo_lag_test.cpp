#include "softfinger/actuation/servo_lag.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kSampleTime = 0.01;  // s
constexpr double kLeast = 1.0 * deg;

JointAngles told_at(double time) {
  return JointAngles{{0.2 * std::sin(2.0 * time), -0.5 * std::sin(3.0 * time), 0.1}};
}

/// Tells the servos `motion` up to `end` and looks at them when they are `lag` behind.
template <typename Motion>
std::optional<double> seen_behind(const Motion& motion, double end, double lag) {
  ServoLag lags(3, kLeast);
  for (double time = 0.0; time <= end; time += kSampleTime) lags.sent(time, motion(time));
  return lags.seen(end, motion(end - lag));
}

TEST(ServoLag, IsHowFarBehindTheServosAre) {
  for (const double lag : {0.013, 0.05, 0.12}) {
    const auto seen = seen_behind(told_at, 0.4, lag);
    ASSERT_TRUE(seen) << lag;
    EXPECT_NEAR(*seen, lag, 5e-4);
  }
}

TEST(ServoLag, IsNotToldOfServosThatRest) {
  const auto rests = [](double) { return told_at(0.3); };
  EXPECT_FALSE(seen_behind(rests, 0.4, 0.05));
  const auto hardly = [](double time) { return JointAngles{{1.0 * deg * time, 0.0, 0.0}}; };
  EXPECT_FALSE(seen_behind(hardly, 0.4, 0.05));
}

TEST(ServoLag, IsNotToldOfWhereTheServosWereNeverSent) {
  ServoLag lags(3, kLeast);
  for (double time = 0.0; time <= 0.4; time += kSampleTime) lags.sent(time, told_at(time));
  EXPECT_FALSE(lags.seen(0.4, told_at(0.5)));   // ahead of all
  EXPECT_FALSE(lags.seen(0.4, -told_at(0.3)));  // never there
  EXPECT_TRUE(lags.seen(0.4, told_at(0.3)));
  lags.reset();
  EXPECT_FALSE(lags.seen(0.4, told_at(0.3)));
}

TEST(ServoLag, LooksOnlySinceTheMotionTurnedLast) {
  // There and back: the servo is where it was twice told to be.
  const auto swings = [](double time) {
    return JointAngles{{0.5 * std::abs(time - 0.2), 0.0, 0.0}};
  };
  const auto seen = seen_behind(swings, 0.4, 0.05);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(*seen, 0.05, 1e-9);
}

}  // namespace
}  // namespace softfinger
