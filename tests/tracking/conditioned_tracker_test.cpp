#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "softfinger/base/units.hpp"
#include "softfinger/tracking/conditioning/conditioning_effect.hpp"

namespace softfinger {
namespace {

/// A finger that rests, then explores: still for a second, then strokes of up to 0.1 m/s with a
/// nod.
Pose true_pose(double time) {
  const double moving = std::max(0.0, time - 1.0);
  const double reach = std::min(1.0, moving);
  return {exp_rotation({0.0, 0.3 * reach * std::sin(5.0 * moving), 0.0}),
          {20 * mm * reach * std::sin(5.0 * moving), 0.0, 5 * mm * reach * std::cos(9.0 * moving)}};
}

/// It as a camera system sees it, and at times does not.
class NoisyTracker final : public Tracker {
 public:
  explicit NoisyTracker(double noise)
      : seen_(true_pose, {.noise = noise, .turn_noise = 0.0, .seed = 3}) {}

  TrackedPose sample(double time) override {
    TrackedPose pose = seen_.sample(time);
    pose.valid = pose.valid && (time < lost_from || time > lost_to);
    return pose;
  }
  std::optional<double> end_time() const override { return std::nullopt; }

  double lost_from = 1e9, lost_to = 1e9;

 private:
  DegradedTracker seen_;
};

/// Root of the mean squared distance, m, and turn, rad, from the truth over [from, to] of run time.
struct Error {
  double distance = 0.0, turn = 0.0;
};
Error error_of(Tracker& tracker, double from, double to, double ahead = 0.0) {
  Error sum;
  int count = 0;
  for (int step = 0; step < to * 1000; ++step) {
    const double time = step / 1000.0;
    const Pose pose = tracker.sample(time).X_WFt;
    if (time < from) continue;
    const Pose truth = true_pose(time + ahead);
    sum.distance += (pose.translation - truth.translation).squaredNorm();
    sum.turn += log_rotation(truth.rotation.transpose() * pose.rotation).squaredNorm();
    ++count;
  }
  return {std::sqrt(sum.distance / count), std::sqrt(sum.turn / count)};
}

ConditionedTracker conditioned(double noise, const PoseConditioning& conditioning) {
  return {std::make_unique<NoisyTracker>(noise), conditioning};
}

TEST(ConditionedTracker, WithNothingAskedGivesWhatCame) {
  NoisyTracker plain(0.1 * mm);
  ConditionedTracker tracker = conditioned(0.1 * mm, {});
  int valid = 0;
  for (int step = 0; step < 3000; ++step) {
    const TrackedPose expected = plain.sample(step / 1000.0);
    const TrackedPose pose = tracker.sample(step / 1000.0);
    ASSERT_EQ(pose.valid, expected.valid);
    if (!pose.valid) continue;
    ++valid;
    ASSERT_EQ(pose.X_WFt.translation, expected.X_WFt.translation) << step;
  }
  EXPECT_GT(valid, 2000);
}

TEST(ConditionedTracker, FilterStillsAFingerAtRestAndFollowsOneThatMoves) {
  const double noise = 0.1 * mm;
  const auto filtered = [&] { return conditioned(noise, {.filter = OneEuroSettings{}}); };
  NoisyTracker plain(noise);
  NoisyTracker plain_moving(noise);
  ConditionedTracker still = filtered();
  ConditionedTracker moving = filtered();
  const double before = error_of(plain, 0.3, 1.0).distance;
  const double after = error_of(still, 0.3, 1.0).distance;
  const double raw = error_of(plain_moving, 2.0, 5.0).distance;
  const double smooth = error_of(moving, 2.0, 5.0).distance;
  std::cout << "at rest " << before / mm << " -> " << after / mm << " mm; moving " << raw / mm
            << " -> " << smooth / mm << " mm\n";
  EXPECT_LT(after, 0.6 * before);
  EXPECT_LT(smooth, 1.2 * raw);  // its own lag, on top of the poses' age
}

TEST(ConditionedTracker, PredictionTakesOffMostOfTheAge) {
  for (const double noise : {0.0, 0.02 * mm}) {
    NoisyTracker plain(noise);
    ConditionedTracker tracker = conditioned(noise, {.lead = 0.0});
    const Error before = error_of(plain, 2.0, 5.0);
    const Error after = error_of(tracker, 2.0, 5.0);
    std::cout << "noise " << noise / mm << " mm: " << before.distance / mm << " -> "
              << after.distance / mm << " mm, " << before.turn / deg << " -> " << after.turn / deg
              << " deg\n";
    EXPECT_LT(after.distance, 0.5 * before.distance);
    EXPECT_LT(after.turn, 0.5 * before.turn);
  }
}

TEST(ConditionedTracker, LeadIsTimeAhead) {
  NoisyTracker plain(0.0);
  ConditionedTracker tracker = conditioned(0.0, {.lead = 20 * ms});
  EXPECT_LT(error_of(tracker, 2.0, 5.0, 20 * ms).distance,
            0.5 * error_of(plain, 2.0, 5.0, 20 * ms).distance);
}

TEST(ConditionedTracker, SaysWhatIsMadeOfPoses) {
  const OneEuroSettings filter;
  EXPECT_EQ(conditioning_text({}, false), "");
  EXPECT_EQ(conditioning_text({}, true), "interpolated");
  EXPECT_EQ(conditioning_text({.filter = filter}, true), "filtered, interpolated");
  EXPECT_EQ(conditioning_text({.filter = filter}, false), "filtered");
  EXPECT_EQ(conditioning_text({.lead = 0.0}, true), "carried on by 0 ms");
  EXPECT_EQ(conditioning_text({.filter = filter, .lead = 12.5 * ms}, true),
            "filtered, carried on by 12.5 ms");
}

TEST(ConditioningEffect, IsWhatTheTrackersThemselvesShow) {
  const PoseConditioning conditioning{.filter = OneEuroSettings{}};
  const TrackingQuality quality{.noise = 0.1 * mm, .turn_noise = 0.0, .seed = 3};
  const ConditioningEffect effect = conditioning_effect(true_pose, 5.0, quality, conditioning);
  // It begins when the first pose has come, and the last moments of rest are already a start.
  EXPECT_NEAR(effect.resting.time, 1.0, 0.15);
  EXPECT_NEAR(effect.resting.time + effect.moving.time, 5.0, 0.05);
  // Either as a run plays it.
  const auto error_with = [&](const PoseConditioning& changes) {
    const auto tracker =
        softfinger::conditioned(std::make_unique<NoisyTracker>(0.1 * mm), changes, true);
    return error_of(*tracker, 5.0 - effect.moving.time, 5.0).distance;
  };
  EXPECT_NEAR(effect.moving.before.distance, error_with({}), 0.02 * mm);
  EXPECT_NEAR(effect.moving.after.distance, error_with(conditioning), 0.05 * mm);
}

TEST(ConditioningEffect, WithoutNoiseAndAgeThereIsNothingToMend) {
  const TrackingQuality perfect{.rate = 1000.0, .age = 0.0, .noise = 0.0, .turn_noise = 0.0};
  const ConditioningEffect effect = conditioning_effect(true_pose, 3.0, perfect, {.lead = 0.0});
  EXPECT_LT(effect.moving.before.distance, 0.11 * mm);  // 0.1 m/s for a millisecond at most
  EXPECT_LT(effect.moving.after.distance, 0.11 * mm);
  EXPECT_LT(effect.resting.before.turn, 1e-12);
}

TEST(ConditionedTracker, NothingIsCarriedFar) {
  // A source that falls silent without saying so: its last pose is carried on for 100 ms at most.
  class Silent final : public Tracker {
   public:
    TrackedPose sample(double time) override {
      const double taken = std::min(time, 1.0);
      return {.time = taken, .X_WFt = {Matrix3::Identity(), {0.5 * taken, 0, 0}}, .valid = true};
    }
    std::optional<double> end_time() const override { return std::nullopt; }
  };
  ConditionedTracker tracker(std::make_unique<Silent>(), {.lead = 0.0});
  double farthest = 0.0;
  for (int step = 0; step < 3000; ++step) {
    farthest = tracker.sample(step / 1000.0).X_WFt.translation.x();
  }
  EXPECT_NEAR(farthest, 0.5 + 0.5 * PoseConditioning::kFarthest, 1e-3);
}

TEST(ConditionedTracker, BeginsAnewAfterALoss) {
  auto source = std::make_unique<NoisyTracker>(0.0);
  source->lost_from = 2.0;
  source->lost_to = 2.5;
  NoisyTracker plain(0.0);
  ConditionedTracker tracker(std::move(source), {.filter = OneEuroSettings{}, .lead = 0.0});
  for (int step = 0; step < 2600; ++step) {
    const double time = step / 1000.0;
    const TrackedPose pose = tracker.sample(time);
    const TrackedPose came = plain.sample(time);
    if (time > 2.0 + 1e-6 && time < 2.5) {
      ASSERT_FALSE(pose.valid);
    }
    if (pose.valid) {
      // At most what 0.15 m/s make of the age, whatever was before.
      ASSERT_LT((pose.X_WFt.translation - came.X_WFt.translation).norm(), 5 * mm) << time;
    }
  }
}

TEST(OneEuroFilter, DoesNotCareHowOftenPosesCome) {
  // A step, seen at 100 and at 400 Hz: after a tenth of a second both are as far.
  const Pose there{exp_rotation({0.0, 0.0, 0.2}), {1 * mm, 0, 0}};
  const auto after = [&](double rate) {
    OneEuroFilter filter({.per_speed = 0.0, .per_turn_rate = 0.0});
    filter.reset({});
    Pose pose;
    for (int k = 0; k < 0.1 * rate; ++k) pose = filter.update(there, 1.0 / rate);
    return pose;
  };
  const Pose slow = after(100.0);
  const Pose fast = after(400.0);
  EXPECT_NEAR(slow.translation.x(), fast.translation.x(), 0.05 * mm);
  EXPECT_NEAR(log_rotation(slow.rotation).z(), log_rotation(fast.rotation).z(), 0.01);
}

}  // namespace
}  // namespace softfinger
