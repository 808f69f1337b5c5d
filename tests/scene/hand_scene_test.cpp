// Hands of a scene file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Scene hand_scene(const std::string& text) {
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const auto file = std::filesystem::path(testing::TempDir()) / (test + "_hand.toml");
  std::ofstream(file, std::ios::binary) << text;
  return load_scene(file);
}

std::string hand_refusal(const std::string& text) {
  try {
    (void)hand_scene(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

constexpr const char* kWaypoint =
    "[[hand.waypoint]]\ntime_s = 0\nposition_mm = [10, 20, 30]\nindex_deg = [0, 30, 60]\n";
/// Keys of the hand from line 2 on; without waypoints of its own.
std::string hand_with(const std::string& keys) { return "[[hand]]\n" + keys + kWaypoint; }
std::string finger_of_hand(const std::string& name, const std::string& keys) {
  return "[[finger]]\nname = \"" + name + "\"\nmodel = \"index.toml\"\n" + keys;
}

TEST(HandOfAScene, ItsBonesAreObjectsBehindTheOthers) {
  const Scene scene = hand_scene(hand_with("size = 1.1\nforce_limit_N = 7\n") +
                                 "[[object]]\nname = \"floor\"\nshape = \"plane\"\n");
  ASSERT_EQ(scene.hands.size(), 1U);
  EXPECT_EQ(scene.hands[0].name, "right");
  EXPECT_EQ(scene.hands[0].first_object, 1U);
  ASSERT_EQ(scene.objects.size(), 1U + kHandPieces.size());
  EXPECT_EQ(scene.objects[0].hand(), -1);
  const VirtualObject& proximal = scene.objects[4];
  EXPECT_EQ(proximal.name, "right-index-proximal");
  EXPECT_EQ(proximal.hand(), 0);
  const auto& capsule = std::get<TaperedCapsule>(proximal.shape);
  EXPECT_NEAR(capsule.half_length, 0.5 * 1.1 * 39.78 * mm, 1e-12);
  EXPECT_EQ(proximal.dynamics->following->force_limit, 7.0);
  EXPECT_GT(proximal.dynamics->mass, 5e-3);
  EXPECT_LT(proximal.dynamics->mass, 40e-3);
  const HandPose start = scene.hands[0].script->sample(0.0);
  const Vector3 away = proximal.motion.sample(0.0).translation - start.pieces[3].translation;
  EXPECT_LT(away.norm(), 1e-12);
}

TEST(HandOfAScene, FingersFollowIt) {
  const Scene scene = hand_scene(hand_with("") + finger_of_hand("index", "hand = \"right\"\n"));
  ASSERT_EQ(scene.fingers.size(), 1U);
  EXPECT_EQ(scene.fingers[0].hand, 0);
  EXPECT_EQ(scene.fingers[0].hand_finger, HandFinger::kIndex);
  const auto tracker = scene.fingers[0].make_tracker({});
  const Pose wanted = scene.hands[0].script->sample(0.0).distal[1];
  EXPECT_LT((tracker->sample(0.0).X_WFt.translation - wanted.translation).norm(), 1e-12);
  EXPECT_EQ(tracker->end_time(), 0.0);
}

TEST(HandOfAScene, FingersOfATrackedHandFollowTheHeadset) {
  const Scene scene = hand_scene("[[hand]]\nside = \"left\"\ntracker = \"webxr\"\n" +
                                 finger_of_hand("left-ring", "hand = \"left\"\n"));
  EXPECT_EQ(scene.fingers[0].tracker, "webxr:left-ring");
  EXPECT_FALSE(scene.hands[0].script.has_value());
  EXPECT_LT(scene.objects[0].motion.sample(0.0).translation.z(), -100.0);
}

TEST(HandOfAScene, IsRefusedInOneLineWithPlaceAndKey) {
  const auto expect = [](const std::string& text, const std::string& place,
                         const std::string& words) {
    const std::string said = hand_refusal(text);
    EXPECT_THAT(said, AllOf(HasSubstr(place), HasSubstr(words)));
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  };
  expect("[[hand]]\n", ":1", "at least one [[hand.waypoint]]");
  expect(hand_with("side = \"both\"\n"), ":2", "side");
  expect(hand_with("force_limit_N = 0\n"), ":2", "force_limit_N");
  expect(hand_with("size = 9\n"), ":2", "size");
  expect(hand_with("tracker = \"csv:a.csv\"\n"), ":2", "tracker");
  expect(hand_with("forcelimit_N = 3\n"), ":2", "did you mean 'force_limit_N'?");
  expect("[[hand]]\n[[hand.waypoint]]\ntime_s = 0\nposition_mm = [0, 0, 0]\nindex_deg = [1]\n",
         ":5", "index_deg");
  expect(hand_with("") + hand_with(""), ":6", "two hands are named 'right'");
  expect(hand_with("") + finger_of_hand("index", "hand = \"left\"\n"), ":9",
         "no hand is named 'left'");
  expect(hand_with("") + finger_of_hand("pen", "hand = \"right\"\n"), ":7", "no finger of a hand");
  expect(hand_with("") + finger_of_hand("index", "hand = \"right\"\n") +
             finger_of_hand("right-index", "hand = \"right\"\n"),
         ":13", "two fingers that are its index");
  expect(hand_with("") + "[[object]]\nname = \"right-ring-middle\"\nshape = \"plane\"\n",
         "_hand.toml", "is called as an object is");
  expect("[[object]]\nshape = \"capsule\"\n", ":2", "shape");
}

}  // namespace
}  // namespace softfinger
