#include "softfinger/tracking/stream/jump_gate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softfinger {
namespace {

constexpr double kPeriod = 1.0 / 120.0;  // s

Pose seen_at(double x, double angle = 0.0) {
  return {exp_rotation({0.0, 0.0, angle}), {x, 0.0, 0.0}};
}

TEST(JumpGate, LetsAFastHandThrough) {
  JumpGate gate;
  // To and fro over 0.3 m at up to 4.7 m/s and 30 rad/s.
  for (int i = 0; i < 600; ++i) {
    const double phase = 10.0 * std::numbers::pi * kPeriod * i;
    EXPECT_TRUE(gate.admits(seen_at(0.15 * std::sin(phase), std::sin(phase)), kPeriod * i)) << i;
  }
}

TEST(JumpGate, LeavesOutWhatJumpsAwayAndBack) {
  JumpGate gate;
  for (int i = 0; i < 100; ++i) {
    const bool glitch = i % 3 == 1;
    EXPECT_EQ(gate.admits(seen_at(glitch ? 1.0 : 1e-3 * i), kPeriod * i), !glitch) << i;
  }
}

TEST(JumpGate, LeavesOutABodyThatFlipsOver) {
  JumpGate gate;
  EXPECT_TRUE(gate.admits(seen_at(0.0), 0.0));
  EXPECT_FALSE(gate.admits(seen_at(0.0, std::numbers::pi), kPeriod));
  EXPECT_TRUE(gate.admits(seen_at(0.0, 0.4), 2.0 * kPeriod));
}

TEST(JumpGate, BelievesWhatStays) {
  for (const double distance : {0.2, 1.0, 5.0}) {
    JumpGate gate;
    EXPECT_TRUE(gate.admits(seen_at(0.0), 0.0));
    int left_out = 0;
    double now = kPeriod;
    for (; !gate.admits(seen_at(distance), now); now += kPeriod) ++left_out;
    const double reach = (distance - JumpGate::kMostNoise) / JumpGate::kMostSpeed;
    EXPECT_NEAR(left_out, std::min<double>(reach / kPeriod, JumpGate::kMajority), 1.01);
    EXPECT_FALSE(gate.admits(seen_at(0.0), now + kPeriod));
    EXPECT_TRUE(gate.admits(seen_at(distance), now + 2.0 * kPeriod));
  }
}

TEST(JumpGate, TheMajorityIsBelievedThoughAGlitchCameFirst) {
  JumpGate gate;
  int wrong = 0;
  for (int i = 0; i < 300; ++i) {
    const bool glitch = i % 3 == 0;
    if (gate.admits(seen_at(glitch ? 1.0 : 1e-3 * i), kPeriod * i) == glitch) wrong = i;
  }
  EXPECT_LT(wrong, 4 * JumpGate::kMajority);
}

TEST(JumpGate, TheFirstMayBeAnywhere) {
  JumpGate gate;
  EXPECT_TRUE(gate.admits(seen_at(-40.0, 3.0), 1e-9));
}

}  // namespace
}  // namespace softfinger
