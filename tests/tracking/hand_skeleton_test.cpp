#include "softfinger/tracking/hand_skeleton.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "softfinger/base/units.hpp"
#include "softfinger/tracking/hand_script.hpp"
#include "softfinger/tracking/webxr_tracker.hpp"

namespace softfinger {
namespace {

HandAngles any_angles(unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> angle(0.0, 1.0);
  HandAngles angles;
  for (Vector3& finger : angles) {
    finger = Vector3(0.2 * angle(generator), angle(generator), angle(generator));
  }
  return angles;
}

Vector3 end_of(const Pose& piece, double length, double side) {
  return piece * Vector3(side * 0.5 * length, 0.0, 0.0);
}

TEST(HandSkeleton, BonesFollowOneAnother) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const HandSide side = seed % 2 == 0 ? HandSide::kRight : HandSide::kLeft;
    const double size = 0.8 + 0.02 * seed;
    const HandPose hand = hand_pose(
        side, size, {exp_rotation(Vector3(0.1, 0.2, seed)), Vector3(1, 2, 3)}, any_angles(seed));
    for (std::size_t p = 0; p < kHandPieces.size(); ++p) {
      const HandPiece& piece = kHandPieces[p];
      const Vector3 end = end_of(hand.pieces[p], size * piece.length, 1.0);
      const bool last =
          p + 1 == kHandPieces.size() || kHandPieces[p + 1].bone == HandBone::kMetacarpal;
      const auto finger = static_cast<std::size_t>(piece.finger);
      const Vector3 next = last
                               ? end_of(hand.distal[finger], size * kDistalLengths[finger], -1.0)
                               : end_of(hand.pieces[p + 1], size * kHandPieces[p + 1].length, -1.0);
      EXPECT_LT((end - next).norm(), 1e-12) << p;
      EXPECT_NEAR(hand.pieces[p].rotation.determinant(), 1.0, 1e-12);
    }
  }
}

TEST(HandSkeleton, FlatFingersPointAwayAndFlexionTurnsThemDown) {
  HandAngles angles;
  angles.fill(Vector3::Zero());
  const HandPose flat = hand_pose(HandSide::kRight, 1.0, {}, angles);
  EXPECT_LT((flat.distal[2].rotation - Matrix3::Identity()).norm(), 1e-12);
  EXPECT_GT(flat.distal[1].translation.y(), flat.distal[4].translation.y() + 40 * mm);
  EXPECT_GT(flat.distal[0].translation.y(), flat.distal[1].translation.y()) << "thumb beside it";
  angles[2] = Vector3(0.0, 0.0, 0.75 * std::numbers::pi / 2);
  const HandPose bent = hand_pose(HandSide::kRight, 1.0, {}, angles);
  // The last two joints, by 67.5 and 45 degrees.
  const double turn = 112.5 * deg;
  EXPECT_LT((bent.distal[2].rotation.col(0) - Vector3(std::cos(turn), 0, -std::sin(turn))).norm(),
            1e-12);
  // In front of the palm the thumb's pad looks to the fingers' side.
  angles.fill(Vector3::Zero());
  angles[0] = Vector3(90 * deg, 0.0, 0.0);
  const HandPose opposed = hand_pose(HandSide::kRight, 1.0, {}, angles);
  EXPECT_LT(opposed.distal[0].translation.z(), -40 * mm);
  EXPECT_LT(-opposed.distal[0].rotation.col(2).x(), 0.8);
  EXPECT_GT(-opposed.distal[0].rotation.col(2).x(), 0.5);
}

TEST(HandSkeleton, LeftHandIsTheMirrorImage) {
  const Vector3 across(1.0, -1.0, 1.0);
  for (unsigned seed = 0; seed < 5; ++seed) {
    const HandAngles angles = any_angles(seed);
    const HandPose right = hand_pose(HandSide::kRight, 1.0, {}, angles);
    const HandPose left = hand_pose(HandSide::kLeft, 1.0, {}, angles);
    for (std::size_t p = 0; p < kHandPieces.size(); ++p) {
      const Vector3 tip(0.01, 0.0, 0.02);
      EXPECT_LT((left.pieces[p] * tip - across.cwiseProduct(right.pieces[p] * tip)).norm(), 1e-12);
    }
  }
}

TEST(HandSkeleton, PiecesAreBonesOfAHeadsetsHand) {
  // Joints numbered as the standard has them: wrist, then metacarpal, proximal, (intermediate,)
  // distal, tip of each finger.
  const std::array<std::size_t, kHandPieces.size()> joints{1,  2,  5,  6,  7,  10, 11,
                                                           12, 15, 16, 17, 20, 21, 22};
  for (std::size_t p = 0; p < joints.size(); ++p) EXPECT_EQ(joint_of(p), joints[p]);
}

TEST(HandScript, GoesThroughItsWaypoints) {
  HandWaypoint open{.time = 0.0, .X_WH = {}};
  HandWaypoint closed{.time = 1.0, .X_WH = {Matrix3::Identity(), Vector3(0.0, 0.0, 0.1)}};
  closed.angles = any_angles(1);
  HandScript script(HandSide::kLeft, 1.1, {open, closed});
  EXPECT_EQ(script.end_time(), 1.0);
  for (const HandWaypoint& at : {open, closed}) {
    const HandPose wanted = hand_pose(HandSide::kLeft, 1.1, at.X_WH, at.angles);
    const HandPose found = script.sample(at.time);
    EXPECT_LT((found.pieces[7].translation - wanted.pieces[7].translation).norm(), 1e-12);
    HandScriptTracker thumb(script, HandFinger::kThumb);
    const TrackedPose tracked = thumb.sample(at.time);
    EXPECT_TRUE(tracked.valid);
    EXPECT_LT((tracked.X_WFt.translation - wanted.distal[0].translation).norm(), 1e-12);
  }
}

TEST(WebXrTracker, FollowsABoneThatIsNoFingertip) {
  WebXrTracker tracker(Pose{}, HandSide::kRight, joint_of(3));
  EXPECT_FALSE(tracker.sample(0.0).valid);
  XrHand hand{.side = HandSide::kRight, .tracked = true, .time = 1.0, .joints = {}};
  hand.joints[6].position = {0.0F, 0.0F, -0.1F};
  hand.joints[7].position = {0.0F, 0.0F, -0.14F};
  tracker.offer(hand);
  const TrackedPose tracked = tracker.sample(0.01);
  EXPECT_TRUE(tracked.valid);
  EXPECT_LT((tracked.X_WFt.translation - Vector3(0.12, 0.0, 0.0)).norm(), 1e-7);
}

}  // namespace
}  // namespace softfinger
