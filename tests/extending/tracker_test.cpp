// The worked example of docs/extending.md: a tracker of one's own.
#include <gtest/gtest.h>

#include "softfinger/base/error.hpp"
#include "tracker/circle_tracker.hpp"

namespace softfinger {
namespace {

TEST(CircleTracker, StaysOnItsCircleAndComesRound) {
  const Vector3 centre(0.01, -0.02, 0.03);
  CircleTracker tracker(centre, 5e-3, 2.0, 3.0);
  const Vector3 begin = tracker.sample(0.0).X_WFt.translation;
  double way = 0.0;
  Vector3 last = begin;
  for (int i = 1; i <= 2000; ++i) {
    const TrackedPose tracked = tracker.sample(1e-3 * i);
    ASSERT_TRUE(tracked.valid);
    const Vector3 arm = tracked.X_WFt.translation - centre;
    EXPECT_NEAR(arm.norm(), 5e-3, 1e-12);
    EXPECT_EQ(arm.z(), 0.0);
    way += (tracked.X_WFt.translation - last).norm();
    last = tracked.X_WFt.translation;
  }
  EXPECT_LT((last - begin).norm(), 1e-12);
  EXPECT_NEAR(way, 2.0 * 3.14159265 * 5e-3, 1e-7);
  EXPECT_DOUBLE_EQ(tracker.end_time().value(), 6.0);
}

TEST(CircleTracker, RefusesWhatIsNoCircle) {
  EXPECT_THROW(CircleTracker(Vector3::Zero(), -1e-3, 1.0, 1.0), InputError);
  EXPECT_THROW(CircleTracker(Vector3::Zero(), 1e-3, 0.0, 1.0), InputError);
}

}  // namespace
}  // namespace softfinger
