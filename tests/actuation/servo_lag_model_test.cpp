#include "softfinger/actuation/servo_lag.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <vector>

namespace softfinger {
namespace {

struct ToldTo {
  double time;
  JointAngles joints;
};

constexpr std::size_t kLagKept = 256;  ///< entries
constexpr double kLagLeast = 2.0;

/// The entries, oldest first, since when the joint has gone one way; the newest at least.
std::span<const ToldTo> run_of(std::span<const ToldTo> told, Eigen::Index joint) {
  std::size_t length = 1;
  for (std::size_t k = told.size() - 1; k > 0 && length < kLagKept; --k) {
    const double step = told[k].joints[joint] - told[k - 1].joints[joint];
    const double last = told.back().joints[joint] - told[told.size() - 2].joints[joint];
    if (!(step > 0.0 && last > 0.0) && !(step < 0.0 && last < 0.0)) break;
    ++length;
  }
  return told.last(length);
}

/// The same by another way: the run of the joint that went furthest is a function of time that can
/// be inverted.
std::optional<double> lag_by_inversion(const std::vector<ToldTo>& told, double time,
                                       const JointAngles& joints) {
  Eigen::Index furthest = -1;
  double most = kLagLeast;
  std::span<const ToldTo> run;
  for (Eigen::Index joint = 0; joint < joints.size() && !told.empty(); ++joint) {
    const std::span<const ToldTo> of_joint = run_of(told, joint);
    const double moved = std::abs(of_joint.back().joints[joint] - of_joint.front().joints[joint]);
    if (moved < most) continue;
    furthest = joint;
    most = moved;
    run = of_joint;
  }
  if (furthest < 0) return std::nullopt;
  const double place = joints[furthest];
  for (std::size_t k = 0; k + 1 < run.size(); ++k) {
    const double from = run[k].joints[furthest];
    const double to = run[k + 1].joints[furthest];
    if (place < std::min(from, to) || place > std::max(from, to)) continue;
    const double when = std::lerp(run[k].time, run[k + 1].time, (place - from) / (to - from));
    if (when > time) return std::nullopt;
    return time - when;
  }
  return std::nullopt;
}

// Steps are few and whole, so that joints turn, rest, tie, and are seen just where they were told
// to be.
TEST(ServoLagModel, IsThatOfTheMotionInverted) {
  std::mt19937 random(23);
  const auto whole = [&](int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(random);
  };
  int seen = 0;
  int unseen = 0;
  for (int trial = 0; trial < 400; ++trial) {
    ServoLag lags(2, kLagLeast);
    std::vector<ToldTo> told;
    JointAngles joints{{10.0, -20.0}};
    JointAngles speed{{1.0, -1.0}};
    double time = 5.0;
    for (int k = 0; k < 24; ++k) {
      if (k == 12 && trial % 4 == 0) {
        lags.reset();
        told.clear();
      }
      for (int look = 0; look < 6; ++look) {
        const JointAngles standing{
            {joints[0] + 0.25 * whole(-20, 20), joints[1] + 0.25 * whole(-20, 20)}};
        const double at = time + 0.5 * whole(-4, 2);
        const auto expected = lag_by_inversion(told, at, standing);
        const auto lag = lags.seen(at, standing);
        ASSERT_EQ(lag.has_value(), expected.has_value()) << trial << ' ' << k;
        if (lag) {
          ASSERT_NEAR(*lag, *expected, 1e-9);
        }
        ++(lag ? seen : unseen);
      }
      time += 0.25 * whole(1, 4);
      for (int i = 0; i < 2; ++i) {
        if (whole(0, 3) == 0) speed[i] = whole(-2, 2);
        joints[i] += speed[i];
      }
      lags.sent(time, joints);
      told.push_back({time, joints});
    }
  }
  EXPECT_GT(seen, 1000);
  EXPECT_GT(unseen, 1000);
}

TEST(ServoLagModel, KeepsSoMuchAndNoMore) {
  ServoLag lags(1, kLagLeast);
  std::vector<ToldTo> told;
  for (int k = 0; k < 700; ++k) {
    told.push_back({0.5 * k, JointAngles{{3.0 + k}}});
    lags.sent(told.back().time, told.back().joints);
    for (const int behind : {0, 1, 200, 254, 255, 256, 257, 300}) {
      const JointAngles standing{{3.0 + k - behind}};
      const auto lag = lags.seen(told.back().time, standing);
      ASSERT_EQ(lag, lag_by_inversion(told, told.back().time, standing)) << k << ' ' << behind;
    }
  }
}

}  // namespace
}  // namespace softfinger
