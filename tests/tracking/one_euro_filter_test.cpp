#include "softfinger/tracking/conditioning/one_euro_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kFilterStep = 1e-3;

// Without speed in it, it is the low-pass of its cutoff: in 1 / (2 pi cutoff) a jump falls to 1 /
// e.
TEST(OneEuroFilter, IsALowPassWhereSpeedDoesNotCount) {
  for (const double cutoff : {1.0, 4.0, 20.0}) {
    constexpr double kShort = 1e-5;  // s
    OneEuroFilter filter({.min_cutoff = cutoff, .per_speed = 0.0, .per_turn_rate = 0.0});
    filter.reset({});
    const Pose there{exp_rotation({0.0, 0.0, 0.5}), Vector3(1.0, -2.0, 3.0) * mm};
    const double time_constant = 1.0 / (2.0 * std::numbers::pi * cutoff);
    Pose smoothed;
    for (double time = 0.0; time < time_constant; time += kShort) {
      smoothed = filter.update(there, kShort);
    }
    const double left = 1.0 / std::numbers::e;
    EXPECT_NEAR((there.translation - smoothed.translation).norm() / there.translation.norm(), left,
                0.003)
        << cutoff;
    EXPECT_NEAR(log_rotation(smoothed.rotation.transpose() * there.rotation).norm() / 0.5, left,
                0.003);
  }
}

TEST(OneEuroFilter, StillsWhatTremblesAndFollowsWhatMoves) {
  const OneEuroSettings settings;
  const OneEuroSettings closed{.per_speed = 0.0, .per_turn_rate = 0.0};
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1e-5);
  OneEuroFilter at_rest(settings), open(settings), shut(closed);
  for (OneEuroFilter* filter : {&at_rest, &open, &shut}) filter->reset({});
  double trembling = 0.0, smoothed = 0.0, lag = 0.0, lag_shut = 0.0;
  for (int k = 1; k <= 2000; ++k) {
    const Vector3 jitter(noise(random), noise(random), noise(random));
    trembling += jitter.squaredNorm();
    smoothed +=
        at_rest.update({Matrix3::Identity(), jitter}, kFilterStep).translation.squaredNorm();
    const Pose moving{Matrix3::Identity(), Vector3(0.2 * k * kFilterStep, 0.0, 0.0)};  // 200 mm/s
    lag = (moving.translation - open.update(moving, kFilterStep).translation).norm();
    lag_shut = (moving.translation - shut.update(moving, kFilterStep).translation).norm();
  }
  EXPECT_LT(smoothed, 0.25 * trembling);
  // v / (2 pi f), of the cutoff that the speed opens.
  EXPECT_NEAR(lag, 0.2 / (2.0 * std::numbers::pi * 204.0), 1e-5);
  EXPECT_NEAR(lag_shut, 0.2 / (2.0 * std::numbers::pi * 4.0), 1e-4);
}

TEST(OneEuroFilter, DoesNotKnowWhereItIsSeenFrom) {
  const Pose X_VW{exp_rotation({0.3, -1.1, 0.7}), Vector3(4.0, 5.0, 6.0)};
  OneEuroFilter one({}), other({});
  one.reset({});
  other.reset(X_VW);
  for (int k = 0; k < 200; ++k) {
    const double t = k * kFilterStep;
    const Pose pose{exp_rotation({std::sin(30 * t), 2 * t, 0.0}),
                    Vector3(std::sin(20 * t), t, 0.0)};
    const Pose expected = X_VW * one.update(pose, kFilterStep);
    const Pose seen = other.update(X_VW * pose, kFilterStep);
    EXPECT_LT((seen.translation - expected.translation).norm(), 1e-12);
    EXPECT_LT((seen.rotation - expected.rotation).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace softfinger
