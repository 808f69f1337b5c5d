#include "softfinger/tracking/webxr_tracker.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/tracking/make_tracker.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {
namespace {

constexpr double kRounding = 1e-7;

/// A right hand held out flat, palm down, its fingers along -z of K: joint axes are those of K.
/// The distal joint and the tip of the index finger lie 22 mm apart.
XrHand flat_hand(double time, float height = 1.2F) {
  XrHand hand{.side = HandSide::kRight, .tracked = true, .time = time, .joints = {}};
  for (std::size_t k = 0; k < kXrJointCount; ++k) {
    hand.joints[k].position = {static_cast<float>(k), height, 0.0F};
    hand.joints[k].radius = 0.008F;
  }
  hand.joints[8].position = {0.1F, height, -0.3F};
  hand.joints[9].position = {0.1F, height, -0.322F};
  return hand;
}

TEST(DistalPhalanxPose, OfAFlatHandPointsAwayWithThePadDown) {
  const Pose X_WFt = distal_phalanx_pose(flat_hand(0.0), HandFinger::kIndex);
  EXPECT_LT((X_WFt.rotation - Matrix3::Identity()).norm(), kRounding);
  EXPECT_LT((X_WFt.translation - Vector3(0.311, -0.1, 1.2)).norm(), kRounding);
}

TEST(DistalPhalanxPose, FollowsTheAxesOfTheJoint) {
  // A quarter turn about the joint's own x: it points up, its palm's side away from the wearer.
  XrHand hand = flat_hand(0.0);
  const auto half = static_cast<float>(std::numbers::pi / 4);
  hand.joints[8].rotation = {std::cos(half), std::sin(half), 0.0F, 0.0F};
  hand.joints[9].position = hand.joints[8].position + Eigen::Vector3f(0.0F, 0.022F, 0.0F);
  const Pose X_WFt = distal_phalanx_pose(hand, HandFinger::kIndex);
  EXPECT_LT((X_WFt.rotation.col(0) - Vector3::UnitZ()).norm(), kRounding) << "x out of the tip";
  EXPECT_LT((X_WFt.rotation.col(1) - Vector3::UnitY()).norm(), kRounding) << "y to the left";
  EXPECT_LT((X_WFt.rotation.col(2) + Vector3::UnitX()).norm(), kRounding) << "z out of the nail";
  EXPECT_LT((X_WFt.translation - Vector3(0.3, -0.1, 1.211)).norm(), kRounding);
}

TEST(DistalPhalanxPose, EveryFingerHasItsDistalJointAndTip) {
  const XrHand hand = flat_hand(0.0);
  const auto y_of = [&](HandFinger finger) {
    return distal_phalanx_pose(hand, finger).translation.y();
  };
  EXPECT_DOUBLE_EQ(y_of(HandFinger::kThumb), -3.5);
  EXPECT_DOUBLE_EQ(y_of(HandFinger::kMiddle), -13.5);
  EXPECT_DOUBLE_EQ(y_of(HandFinger::kRing), -18.5);
  EXPECT_DOUBLE_EQ(y_of(HandFinger::kPinky), -23.5);
}

TEST(WebXrTracker, IsWhereTheHeadsetSeesTheFinger) {
  const Pose start{Matrix3::Identity(), Vector3(0.0, 0.0, 0.5)};
  WebXrTracker tracker(start, HandSide::kRight, HandFinger::kIndex);
  EXPECT_FALSE(tracker.sample(0.0).valid);
  EXPECT_EQ(tracker.sample(0.0).X_WFt.translation.z(), 0.5);
  tracker.offer(flat_hand(100.0));
  const TrackedPose seen = tracker.sample(1.0);
  EXPECT_TRUE(seen.valid);
  EXPECT_NEAR(seen.time, 1.0, 0.05) << "when it came";
  EXPECT_LE(seen.time, 1.0);
  EXPECT_NEAR(seen.X_WFt.translation.z(), 1.2, kRounding);

  XrHand other = flat_hand(100.1, 0.7F);
  other.side = HandSide::kLeft;
  tracker.offer(other);
  EXPECT_NEAR(tracker.sample(1.05).X_WFt.translation.z(), 1.2, kRounding);
  EXPECT_FALSE(tracker.end_time().has_value());
}

TEST(WebXrTracker, IsLostWhenTheHeadsetSaysSo) {
  WebXrTracker tracker({}, HandSide::kRight, HandFinger::kIndex);
  tracker.offer(flat_hand(1.0));
  ASSERT_TRUE(tracker.sample(1.0).valid);
  tracker.offer({.side = HandSide::kRight, .tracked = false, .time = 1.1, .joints = {}});
  const TrackedPose lost = tracker.sample(1.001);
  EXPECT_FALSE(lost.valid);
  EXPECT_NEAR(lost.X_WFt.translation.z(), 1.2, kRounding) << "the last pose is held";
  tracker.offer(flat_hand(1.2, 1.3F));
  EXPECT_TRUE(tracker.sample(1.1).valid);
}

TEST(WebXrTracker, IsLostWhenNothingNewComes) {
  WebXrTracker tracker({}, HandSide::kRight, HandFinger::kIndex);
  tracker.offer(flat_hand(5.0));
  EXPECT_TRUE(tracker.sample(1.0).valid);
  EXPECT_TRUE(tracker.sample(1.0 + kLostAfter).valid);
  EXPECT_FALSE(tracker.sample(1.001 + kLostAfter).valid);
  // The same picture again and again is not new.
  for (int k = 0; k < 50; ++k) {
    tracker.offer(flat_hand(5.0));
    EXPECT_FALSE(tracker.sample(1.3 + 0.01 * k).valid);
  }
  tracker.offer(flat_hand(5.1));
  EXPECT_TRUE(tracker.sample(2.0).valid);
  tracker.offer(flat_hand(4.9, 3.0F));
  EXPECT_NEAR(tracker.sample(2.1).X_WFt.translation.z(), 1.2, kRounding) << "older than the last";
  // After a silence it is another page, with another clock.
  tracker.offer(flat_hand(0.1, 3.0F));
  EXPECT_NEAR(tracker.sample(2.5).X_WFt.translation.z(), 3.0, kRounding);
}

TEST(WebXrTracker, IsLostWhileALinkDeliversThePast) {
  WebXrTracker tracker(Pose(), HandSide::kRight, HandFinger::kIndex);
  tracker.offer(flat_hand(10.0));
  EXPECT_TRUE(tracker.sample(0.0).valid);
  // It held back what the headset saw for 0.6 s, then brings all of it.
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  for (int frame = 1; frame <= 5; ++frame) {
    tracker.offer(flat_hand(10.0 + 0.011 * frame));
    EXPECT_FALSE(tracker.sample(0.6 + 0.001 * frame).valid) << frame;
  }
  tracker.offer(flat_hand(10.6));
  EXPECT_TRUE(tracker.sample(0.61).valid) << "it is in the present again";
}

TEST(WebXrTracker, SpecsNameSideAndFinger) {
  const auto z_of = [](const char* spec, HandSide side) {
    const auto tracker = make_tracker(spec, {}, {});
    XrHand hand = flat_hand(1.0);
    hand.side = side;
    dynamic_cast<WebXrTracker&>(*tracker).offer(hand);
    return -tracker->sample(0.1).X_WFt.translation.y();
  };
  EXPECT_NEAR(z_of("webxr", HandSide::kRight), 0.1, kRounding);
  EXPECT_NEAR(z_of("webxr:thumb", HandSide::kRight), 3.5, kRounding);
  EXPECT_NEAR(z_of("webxr:left", HandSide::kLeft), 0.1, kRounding);
  EXPECT_NEAR(z_of("webxr:left-pinky", HandSide::kLeft), 23.5, kRounding);
  EXPECT_EQ(z_of("webxr:left-pinky", HandSide::kRight), 0.0) << "the other hand";
  for (const char* spec : {"webxr:", "webxr:toe", "webxr:left-", "webxr:-thumb", "webxr:thumb-left",
                           "webxr:left-thumb-", "webxr:Left", "webxr-left"}) {
    EXPECT_THROW((void)make_tracker(spec, {}, {}), InputError) << spec;
  }
}

TEST(TrackerOfFinger, AWholeHandIsFollowedByName) {
  EXPECT_EQ(tracker_of_finger("webxr", "thumb"), "webxr:right-thumb");
  EXPECT_EQ(tracker_of_finger("webxr:left", "ring"), "webxr:left-ring");
  EXPECT_EQ(tracker_of_finger("webxr", "my-finger"), "webxr:right-index");
  EXPECT_EQ(tracker_of_finger("webxr:pinky", "thumb"), "webxr:pinky");
  EXPECT_EQ(tracker_of_finger("script", "thumb"), "script");
  EXPECT_TRUE(tracks_whole_hand("webxr:right"));
  EXPECT_FALSE(tracks_whole_hand("webxr:right-index"));
  EXPECT_FALSE(tracks_whole_hand("page"));
}

}  // namespace
}  // namespace softfinger
