#include "softfinger/tracking/recorded_tracker.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

TEST(RecordedTracker, GivesEachStepItsEntryToTheBit) {
  const double time_step = 1e-3;
  std::vector<TrackedPose> poses;
  for (int k = 0; k < 5000; ++k) {
    const double x = 0.1 * k / 3.0;
    poses.push_back(
        {.time = x, .X_WFt = {exp_rotation({x, 0, 0}), {x, 0, 0}}, .valid = k % 7 != 0});
  }
  RecordedTracker tracker(poses, time_step);
  for (int k = 0; k < 5000; ++k) {
    // Both ways to count time.
    for (const double time : {k * time_step, k / 1000.0}) {
      const TrackedPose sample = tracker.sample(time);
      const TrackedPose& entry = poses[static_cast<std::size_t>(k)];
      ASSERT_EQ(sample.time, entry.time);
      ASSERT_EQ(sample.valid, entry.valid);
      ASSERT_EQ(sample.X_WFt.translation, entry.X_WFt.translation);
      ASSERT_EQ(sample.X_WFt.rotation, entry.X_WFt.rotation);
    }
  }
  EXPECT_DOUBLE_EQ(*tracker.end_time(), 4.999);
  EXPECT_EQ(tracker.sample(100.0).time, poses.back().time);
  EXPECT_EQ(tracker.sample(-1.0).time, poses.front().time);
  EXPECT_THROW(RecordedTracker({}, time_step), InputError);
}

}  // namespace
}  // namespace softfinger
