#include "softfinger/viewer/hand_message.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace softfinger {
namespace {

/// Bytes of a hand message, made as the page makes them.
struct HandBytes {
  std::uint32_t magic = 0x58484653;
  std::uint32_t flags = 1;
  double time_ms = 12.5;
  std::vector<float> joints = {};

  HandBytes() {
    for (int k = 0; k < 25; ++k) {
      const auto x = static_cast<float>(k) / 100.0F;
      joints.insert(joints.end(), {x, 1.5F, -0.5F, 0.0F, 0.6F, 0.0F, 0.8F, 0.008F});
    }
  }
  [[nodiscard]] std::string text() const {
    std::string bytes(16 + 4 * joints.size(), '\0');
    std::memcpy(bytes.data(), &magic, 4);
    std::memcpy(bytes.data() + 4, &flags, 4);
    std::memcpy(bytes.data() + 8, &time_ms, 8);
    std::memcpy(bytes.data() + 16, joints.data(), 4 * joints.size());
    return bytes;
  }
};

TEST(HandMessage, ReadsEveryJoint) {
  const auto hand = parse_hand_message(HandBytes().text());
  ASSERT_TRUE(hand);
  EXPECT_TRUE(hand->tracked);
  EXPECT_EQ(hand->side, HandSide::kRight);
  EXPECT_DOUBLE_EQ(hand->time, 0.0125);
  for (std::size_t k = 0; k < kXrJointCount; ++k) {
    const XrJoint& joint = hand->joints[k];
    EXPECT_EQ(joint.position, Eigen::Vector3f(static_cast<float>(k) / 100.0F, 1.5F, -0.5F));
    EXPECT_FLOAT_EQ(joint.rotation.y(), 0.6F);
    EXPECT_FLOAT_EQ(joint.rotation.w(), 0.8F);
    EXPECT_EQ(joint.radius, 0.008F);
  }
}

TEST(HandMessage, AHandThatIsNotSeenHasNoJoints) {
  HandBytes bytes;
  bytes.flags = 2;
  EXPECT_FALSE(parse_hand_message(bytes.text())) << "joints of no hand";
  bytes.joints.clear();
  const auto hand = parse_hand_message(bytes.text());
  ASSERT_TRUE(hand);
  EXPECT_FALSE(hand->tracked);
  EXPECT_EQ(hand->side, HandSide::kLeft);
}

TEST(HandMessage, OtherLengthsAreRefused) {
  const std::string whole = HandBytes().text();
  ASSERT_EQ(whole.size(), 816U);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(parse_hand_message(std::string_view(whole).substr(0, size))) << size;
  }
  EXPECT_FALSE(parse_hand_message(whole + '\0'));
}

TEST(HandMessage, OtherHeadersAreRefused) {
  const auto refused = [](auto change) {
    HandBytes bytes;
    change(bytes);
    return !parse_hand_message(bytes.text());
  };
  EXPECT_TRUE(refused([](HandBytes& b) { b.magic ^= 1; }));
  EXPECT_TRUE(refused([](HandBytes& b) { b.flags = 5; }));
  EXPECT_TRUE(refused([](HandBytes& b) { b.flags = 0x80000001; }));
  for (const double time : {-1.0, 1e18, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_TRUE(refused([&](HandBytes& b) { b.time_ms = time; })) << time;
  }
}

TEST(HandMessage, NumbersOutOfBoundsAreRefusedInEveryJoint) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float nan = std::nanf("");
  const auto refused = [](std::size_t joint, std::size_t number, float value) {
    HandBytes bytes;
    bytes.joints[8 * joint + number] = value;
    return !parse_hand_message(bytes.text());
  };
  for (std::size_t joint = 0; joint < kXrJointCount; ++joint) {
    for (std::size_t number = 0; number < 8; ++number) {
      for (const float value : {nan, kInfinity, -kInfinity, 10.1F, -3e38F}) {
        EXPECT_TRUE(refused(joint, number, value)) << joint << ' ' << number << ' ' << value;
      }
    }
    EXPECT_FALSE(refused(joint, 0, 10.0F));
    EXPECT_TRUE(refused(joint, 6, 0.83F)) << "longer than a unit quaternion";
    EXPECT_TRUE(refused(joint, 6, 0.0F));
    EXPECT_TRUE(refused(joint, 7, -0.001F));
    EXPECT_FALSE(refused(joint, 7, 0.0F));
  }
}

}  // namespace
}  // namespace softfinger
