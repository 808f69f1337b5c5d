#include "softfinger/tracking/conditioning/interpolated_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"
#include "softfinger/tracking/stream/pose_feed.hpp"
#include "softfinger/tracking/stream/sender_clock.hpp"

namespace softfinger {
namespace {

constexpr double kSpeed = 0.1;     // m/s
constexpr double kTurnRate = 2.0;  // rad/s
constexpr double kStart = 1000.0;  // s of the monotonic clock
constexpr double kStep = 1e-3;     // s
constexpr double kClock = 77.0;    // s, the sender's ahead of ours
constexpr double kFarthestBehind =
    InterpolatedTracker::kMostDelay + InterpolatedTracker::kMostShift + kStep;  // s
constexpr double kWarm = 0.3;  // s, after which all is even

Pose even_motion(double time) {
  return {exp_rotation({0.0, 0.0, kTurnRate * time}), {kSpeed * time, 0.02, 0.0}};
}

/// Poses of an even motion that a sender with a clock of its own sends through a PoseFeed.
class Sender final : public Tracker {
 public:
  /// `on_the_way(k)`: s, of the k-th pose; negative: it gets lost. Steps come up to `step_late` (s)
  /// late.
  Sender(double rate, std::function<double(int)> on_the_way, double step_late = 0.0)
      : rate_(rate), on_the_way_(std::move(on_the_way)), step_late_(step_late) {}

  TrackedPose sample(double time) override {
    const double late = step_late_ * std::uniform_real_distribution<double>()(random_);
    const double now = kStart + time + late;
    for (; next_ / rate_ <= now - kStart && next_ / rate_ < until; ++next_) {
      const double way = on_the_way_(next_);
      if (way >= 0.0) coming_.emplace(next_ / rate_ + way, next_ / rate_);
    }
    while (!coming_.empty() && kStart + coming_.begin()->first <= now) {
      const auto [arrival, sent] = *coming_.begin();
      coming_.erase(coming_.begin());
      feed.offer(even_motion(sent), clock_.local_time(sent + kClock, kStart + arrival),
                 kStart + arrival);
    }
    return feed.sample(time, now);
  }
  [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }

  PoseFeed feed;
  double until = 1e9;

 private:
  double rate_;
  std::function<double(int)> on_the_way_;
  double step_late_;
  int next_ = 0;
  std::multimap<double, double> coming_;
  SenderClock clock_;
  std::mt19937 random_{7};
};

struct Evenness {
  double least = 1e9, most = 0.0;  ///< speed from step to step, as parts of the true one
  double oldest = 0.0;             ///< s, how long ago the pose was true
  double newest = 1e9;
};

Evenness follow(Tracker& tracker, double from, double until) {
  Evenness seen;
  TrackedPose last;
  for (int step = 0; step * kStep < until; ++step) {
    const double time = step * kStep;
    const TrackedPose pose = tracker.sample(time);
    if (time > from) {
      EXPECT_TRUE(pose.valid) << time;
      const double way = (pose.X_WFt.translation - last.X_WFt.translation).norm();
      const double turn =
          log_rotation(last.X_WFt.rotation.transpose() * pose.X_WFt.rotation).norm();
      EXPECT_NEAR(turn / kTurnRate, way / kSpeed, 1e-9) << "position and rotation go together";
      seen.least = std::min(seen.least, way / (kSpeed * kStep));
      seen.most = std::max(seen.most, way / (kSpeed * kStep));
      const double age = time - pose.X_WFt.translation.x() / kSpeed;
      seen.oldest = std::max(seen.oldest, age);
      seen.newest = std::min(seen.newest, age);
    }
    last = pose;
  }
  return seen;
}

// At any rate that does not divide the simulation's; the delay is one interval beside the poses'
// own age, and one step.
TEST(InterpolatedTracker, AnEvenMotionStaysEven) {
  const double age = 6 * ms;
  for (const double rate : {30.0, 60.0, 75.0, 90.0, 120.0, 144.0, 240.0, 500.0}) {
    auto sender = std::make_unique<Sender>(rate, [&](int) { return age; });
    InterpolatedTracker tracker(std::move(sender));
    const Evenness seen = follow(tracker, kWarm, 3.0);
    EXPECT_GT(seen.least, 0.95) << rate;
    EXPECT_LT(seen.most, 1.05) << rate;
    EXPECT_LT(seen.oldest, age + 1.0 / rate + kStep + 1e-9) << rate;
    Sender held(rate, [&](int) { return age; });
    EXPECT_GT(follow(held, kWarm, 3.0).most, 1.9) << "held between poses, or this shows nothing";
  }
}

TEST(InterpolatedTracker, StaysEvenWherePosesAndStepsAreUnpunctual) {
  for (const double rate : {60.0, 120.0}) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> jitter(1 * ms, 5 * ms);
    auto sender = std::make_unique<Sender>(
        rate, [&](int) { return jitter(random); }, 0.8 * ms);
    InterpolatedTracker tracker(std::move(sender));
    const Evenness seen = follow(tracker, 1.0, 6.0);
    // Now and then one is later than all in the last second, and the newest is held for so long.
    EXPECT_GT(seen.least, 0.5) << rate;
    EXPECT_LT(seen.most, 1.2) << rate;
    EXPECT_LT(seen.oldest, 1.0 / rate + 8 * ms) << rate;
  }
}

// What is lost on the way makes no more than the pose stand still for a while; a sender that is
// seldom heard is not followed from farther behind than is said.
TEST(InterpolatedTracker, NeverPassesTheNewestAndNeverLagsFarBehindIt) {
  for (const double rate : {12.0, 60.0, 120.0}) {
    std::mt19937 random(5);
    std::bernoulli_distribution lost(0.3);
    const auto way = [&](int) { return lost(random) ? -1.0 : 3 * ms; };
    auto sender = std::make_unique<Sender>(rate, way);
    Sender& raw = *sender;
    InterpolatedTracker tracker(std::move(sender));
    double farthest = 0.0;
    for (int step = 0; step < 5000; ++step) {
      const TrackedPose pose = tracker.sample(step * kStep);
      const TrackedPose newest = raw.feed.sample(step * kStep, kStart + step * kStep);
      const double x = pose.X_WFt.translation.x();
      EXPECT_LE(x, newest.X_WFt.translation.x() + 1e-12);
      if (x < newest.X_WFt.translation.x() - 1.001 * kSpeed * kFarthestBehind) {
        EXPECT_NEAR(x, farthest + InterpolatedTracker::kMostSpeedUp * kSpeed * kStep, 1e-9)
            << "it makes up for what was missed";
      }
      EXPECT_GE(x, farthest - 1e-12) << "back";
      EXPECT_LE(pose.time, step * kStep + 1e-12);
      farthest = std::max(farthest, x);
    }
    EXPECT_GT(farthest, 0.4);
  }
}

TEST(InterpolatedTracker, TellsLostTrackingAtOnce) {
  auto sender = std::make_unique<Sender>(120.0, [](int) { return 4 * ms; });
  Sender& raw = *sender;
  InterpolatedTracker tracker(std::move(sender));
  raw.until = 1.0;
  TrackedPose pose, before;
  int step = 0;
  for (; step < 1000; ++step) pose = tracker.sample(step * kStep);
  EXPECT_TRUE(pose.valid);
  // The sender says so.
  raw.feed.lose();
  before = pose;
  pose = tracker.sample(step++ * kStep);
  EXPECT_FALSE(pose.valid);
  EXPECT_EQ(pose.X_WFt.translation, before.X_WFt.translation) << "the last pose is held";
  // It comes back elsewhere: from there on, with nothing in between.
  raw.feed.offer(even_motion(1.2), kStart + 1.2, kStart + 1.2);
  pose = tracker.sample(1.2);
  EXPECT_TRUE(pose.valid);
  EXPECT_EQ(pose.X_WFt.translation, even_motion(1.2).translation);
  // Silence, as long as without interpolation.
  EXPECT_TRUE(tracker.sample(1.2 + kLostAfter - kStep).valid);
  EXPECT_FALSE(tracker.sample(1.2 + kLostAfter + kStep).valid);
}

TEST(InterpolatedTracker, BeforeTheFirstPoseThereIsNone) {
  struct Silent final : Tracker {
    TrackedPose sample(double) override { return {.X_WFt = even_motion(3.0), .valid = false}; }
    [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }
  };
  InterpolatedTracker tracker(std::make_unique<Silent>());
  for (const double time : {0.0, 0.5}) {
    EXPECT_FALSE(tracker.sample(time).valid);
    EXPECT_EQ(tracker.sample(time).X_WFt.translation, even_motion(3.0).translation);
  }
}

// Prediction starts from the newest pose, as ever: nothing is delayed there.
TEST(InterpolatedTracker, PredictionDoesWithoutIt) {
  for (const bool predicts : {false, true}) {
    PoseConditioning conditioning;
    if (predicts) conditioning.lead = 0.0;
    const auto tracker = conditioned(std::make_unique<Sender>(120.0, [](int) { return 5 * ms; }),
                                     conditioning, true);
    const Evenness seen = follow(*tracker, kWarm, 2.0);
    // What all poses spend on the way nobody can know.
    EXPECT_LT(seen.oldest, predicts ? 5.5 * ms : 15 * ms);
    EXPECT_GT(seen.oldest, predicts ? 4.5 * ms : 12 * ms);
  }
}

}  // namespace
}  // namespace softfinger
