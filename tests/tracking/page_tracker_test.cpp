#include "softfinger/tracking/page_tracker.hpp"

#include <gtest/gtest.h>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/tracking/make_tracker.hpp"

namespace softfinger {
namespace {

Pose at(double z) { return {Matrix3::Identity(), Vector3(0.0, 0.0, z)}; }

TEST(PageTracker, IsWhereThePageWantsItWhileThePageSaysSo) {
  PageTracker tracker(at(30 * mm));
  EXPECT_FALSE(tracker.sample(0.0).valid);
  EXPECT_EQ(tracker.sample(0.1).X_WFt.translation.z(), 30 * mm);
  tracker.offer(at(10 * mm));
  tracker.offer(at(20 * mm));
  const TrackedPose first = tracker.sample(1.0);
  EXPECT_TRUE(first.valid);
  EXPECT_NEAR(first.time, 1.0, 0.05) << "when it came";
  EXPECT_LE(first.time, 1.0);
  EXPECT_EQ(first.X_WFt.translation.z(), 20 * mm) << "the newest";
  EXPECT_TRUE(tracker.sample(1.0 + kLostAfter).valid);
  const TrackedPose lost = tracker.sample(1.01 + kLostAfter);
  EXPECT_FALSE(lost.valid);
  EXPECT_EQ(lost.X_WFt.translation.z(), 20 * mm) << "the last pose is held";
  tracker.offer(at(20 * mm));
  EXPECT_TRUE(tracker.sample(2.0).valid) << "an unmoved finger is there all the same";
  EXPECT_FALSE(tracker.end_time().has_value());
}

TEST(PageTracker, StartsAtTheFirstWaypointOrAboveTheOrigin) {
  const auto start = [](const std::vector<Waypoint>& waypoints) {
    return make_tracker("page", {}, waypoints)->sample(0.0).X_WFt.translation.z();
  };
  EXPECT_EQ(start({}), 30 * mm);
  EXPECT_EQ(start({{0.0, at(12 * mm)}, {1.0, at(3 * mm)}}), 12 * mm);
  EXPECT_THROW((void)make_tracker("page:1", {}, {}), InputError);
}

}  // namespace
}  // namespace softfinger
