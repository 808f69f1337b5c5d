// What interpolation makes of motions, at any rate, speed and unpunctuality: how far it is behind,
// how far from the truth, how even, and how it stops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "../support/sent_motion.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"
#include "softfinger/tracking/conditioning/interpolated_tracker.hpp"

namespace softfinger {
namespace {

constexpr double kLook = 1e-3;      // s, between two steps
constexpr double kSettled = 1.0;    // s, then the sender is known
constexpr double kPlayedFor = 4.0;  // s
constexpr double kLever = 0.02;     // m: a radian counts as this far

std::unique_ptr<Tracker> played(const SentMotion::Motion& motion, const Sending& sending) {
  return conditioned(std::make_unique<SentMotion>(motion, sending), {}, true);
}

/// Every way of sending that is looked at.
std::vector<Sending> sendings() {
  std::vector<Sending> all;
  for (const double rate : {30.0, 60.0, 90.0, 120.0, 250.0}) {
    for (const double way_jitter : {0.0, 2 * ms, 5 * ms}) {
      for (const double stamp_jitter : {0.0, 0.5 * ms, 2 * ms}) {
        all.push_back({.rate = rate, .way_jitter = way_jitter, .stamp_jitter = stamp_jitter});
      }
      all.push_back({.rate = rate, .way_jitter = way_jitter, .stamped = false});
    }
  }
  return all;
}

/// s, how far the time that a pose is taken for may be from when it was true, beside its way.
double uncertainty(const Sending& sending) {
  return sending.stamped ? 2.0 * sending.stamp_jitter : sending.way_jitter;
}

/// s: one interval of the sender, what arrivals and stamps vary, and a step.
double stated_delay(const Sending& sending) {
  const double varies =
      sending.stamped ? sending.way_jitter + 2.0 * sending.stamp_jitter : sending.way_jitter;
  return 1.0 / sending.rate + varies + kLook;
}

std::string described(const Sending& sending) {
  return std::to_string(sending.rate) + " Hz, way +" + std::to_string(sending.way_jitter / ms) +
         " ms, stamps " +
         (sending.stamped ? "+-" + std::to_string(sending.stamp_jitter / ms) + " ms" : "none");
}

double distance_between(const Pose& a, const Pose& b) {
  return std::max((a.translation - b.translation).norm(),
                  kLever * log_rotation(a.rotation.transpose() * b.rotation).norm());
}

// The pose of a step is the true one, as long ago as is said, up to what stamps do not know and to
// the chord of an interval; and that is no longer ago than is stated.
TEST(PlayedMotion, IsTheTrueOneDelayedAsStated) {
  for (const double speed : {0.02, 0.1, 0.5}) {
    const double turns = speed / 0.05;  // rad/s, around a circle of 50 mm
    const auto circle = [turns](double time) {
      return Pose{exp_rotation({0.0, 0.0, turns * time}),
                  {50 * mm * std::sin(turns * time), 50 * mm * std::cos(turns * time), 0.0}};
    };
    for (const Sending& sending : sendings()) {
      const auto tracker = played(circle, sending);
      const double interval = 1.0 / sending.rate;
      const double chord = speed * turns * interval * interval / 8.0;
      const double unsure = uncertainty(sending) + 0.5 * ms;
      double most_delay = 0.0, most_error = 0.0;
      for (int step = 0; step * kLook < kPlayedFor; ++step) {
        const double time = step * kLook;
        const TrackedPose pose = tracker->sample(time);
        if (time < kSettled) continue;
        ASSERT_TRUE(pose.valid) << time;
        most_delay = std::max(most_delay, time - pose.time);
        most_error =
            std::max(most_error, distance_between(pose.X_WFt, circle(pose.time - sending.way)));
      }
      EXPECT_LE(most_delay, stated_delay(sending) + 1e-9) << described(sending);
      EXPECT_LE(most_error, speed * unsure + 1.01 * chord) << described(sending) << ", " << speed;
    }
  }
}

/// Least and greatest speed from step to step, as parts of the true one.
struct Speeds {
  double least = 1e9, most = 0.0;
};
Speeds speeds_of(Tracker& tracker, double speed) {
  Speeds seen;
  double before = 0.0;
  for (int step = 0; step * kLook < kPlayedFor; ++step) {
    const double x = tracker.sample(step * kLook).X_WFt.translation.x();
    if (step * kLook > kSettled) {
      seen.least = std::min(seen.least, (x - before) / (speed * kLook));
      seen.most = std::max(seen.most, (x - before) / (speed * kLook));
    }
    before = x;
  }
  return seen;
}

TEST(PlayedMotion, IsNoFasterThanStampsAllowAndNeverGoesBack) {
  const double speed = 0.1;
  const auto line = [speed](double time) {
    return Pose{Matrix3::Identity(), {speed * time, 0.0, 0.0}};
  };
  for (const Sending& sending : sendings()) {
    const Speeds seen = speeds_of(*played(line, sending), speed);
    EXPECT_GE(seen.least, 0.0) << described(sending);
    const double unsure = uncertainty(sending) * sending.rate;
    // Two poses whose stamps are nearer by so much, kLeastShare of an interval at least. Where
    // stamps vary by a whole one, the interval itself is not known well.
    const double crowded = 1.0 / std::max(1.0 - unsure, InterpolatedTracker::kLeastShare);
    EXPECT_LE(seen.most, (unsure < 1.0 ? 1.06 : 1.5) * crowded) << described(sending);
    if (uncertainty(sending) > 0.0) continue;
    EXPECT_LT(seen.most, 1.06) << described(sending);
    EXPECT_GT(seen.least, 0.5) << described(sending);
  }
}

// A hand that stops, as suddenly as hands can or at once, is played to where it stopped and no
// farther, and rests there once the delay is over.
TEST(PlayedMotion, AHandThatStopsStopsWithoutRinging) {
  const double speed = 0.3;
  for (const double braking : {1e-9, 0.03}) {
    const double stops = 2.0;
    const auto halting = [&](double time) {
      const double left = std::clamp((stops - time) / braking, 0.0, 1.0);  // of its speed
      const double way = time < stops - braking
                             ? speed * time
                             : speed * (stops - 0.5 * braking - 0.5 * braking * left * left);
      return Pose{exp_rotation({0.0, way, 0.0}), {way, 0.0, 0.0}};
    };
    const double end = halting(3.0).translation.x();
    for (const Sending& sending : sendings()) {
      const auto tracker = played(halting, sending);
      double farthest = 0.0;
      for (int step = 0; step * kLook < 3.0; ++step) {
        const double time = step * kLook;
        const double x = tracker->sample(time).X_WFt.translation.x();
        ASSERT_GE(x, farthest - 1e-12) << described(sending) << " at " << time;
        ASSERT_LE(x, end + 1e-12) << described(sending) << " at " << time;
        farthest = x;
        if (time > stops + sending.way + 1.0 / sending.rate + stated_delay(sending)) {
          ASSERT_NEAR(x, end, 1e-12) << described(sending) << " at " << time;
        }
      }
    }
  }
}

TEST(PlayedMotion, TheSamePosesGiveTheSameBits) {
  const auto wave = [](double time) {
    return Pose{exp_rotation({0.0, std::sin(7.0 * time), 0.0}), {0.05 * std::sin(time), 0.0, 0.0}};
  };
  const Sending sending{.way_jitter = 8 * ms, .stamp_jitter = 2 * ms, .loss = 0.1};
  const auto one = played(wave, sending), other = played(wave, sending);
  for (int step = 0; step < 5000; ++step) {
    const TrackedPose a = one->sample(step * kLook), b = other->sample(step * kLook);
    ASSERT_EQ(a.X_WFt.translation, b.X_WFt.translation) << step;
    ASSERT_EQ(a.X_WFt.rotation, b.X_WFt.rotation) << step;
    ASSERT_EQ(a.time, b.time) << step;
  }
}

// A sender that becomes twice as fast, or half: delay follows within two seconds and what the
// catching up takes.
TEST(PlayedMotion, TheDelayFollowsTheSender) {
  const auto line = [](double time) { return Pose{Matrix3::Identity(), {0.1 * time, 0.0, 0.0}}; };
  struct Changing final : Tracker {
    explicit Changing(const SentMotion::Motion& motion)
        : slow(motion, {.rate = 40.0}), fast(motion, {.rate = 125.0}) {}
    TrackedPose sample(double time) override {
      const TrackedPose of_slow = slow.sample(time), of_fast = fast.sample(time);
      return time < 2.0 || time > 6.0 ? of_slow : of_fast;
    }
    [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }
    SentMotion slow, fast;
  };
  InterpolatedTracker tracker(std::make_unique<Changing>(line));
  for (int step = 0; step < 8000; ++step) {
    const double time = step * kLook;
    const TrackedPose pose = tracker.sample(time);
    if (time < 0.5 || (time >= 2.0 && time < 4.8) || (time >= 6.0 && time < 6.1)) continue;
    const double interval = time < 2.0 || time > 6.0 ? 1.0 / 40.0 : 1.0 / 125.0;
    ASSERT_NEAR(time - pose.time, interval, 2 * kLook) << time;
  }
}

}  // namespace
}  // namespace softfinger
