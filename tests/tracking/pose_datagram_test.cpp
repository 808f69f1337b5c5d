#include "softfinger/tracking/stream/pose_datagram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace softfinger {
namespace {

PoseMessage message_with_all() {
  return {.X_WFt = {exp_rotation({0.3, -0.2, 1.1}), {0.01, -0.02, 0.03}},
          .valid = true,
          .sequence = 0x01020304,
          .time = 2.0};
}

TEST(PoseDatagram, HasTheDocumentedBytes) {
  PoseMessage message = message_with_all();
  message.X_WFt = {Matrix3::Identity(), {1.0, 0.0, -2.0}};
  const PoseDatagram datagram = encode_pose_datagram(message);
  std::vector<std::uint8_t> expected{'S', 'F', 'P', 'O', 1, 0, 0, 0, 4, 3, 2, 1, 1, 0, 0, 0};
  const auto number = [&](std::uint8_t high, std::uint8_t next) {
    expected.insert(expected.end(), {0, 0, 0, 0, 0, 0, next, high});
  };
  number(0x40, 0x00);  // 2.0 s
  number(0x3f, 0xf0);  // x = 1
  number(0x00, 0x00);
  number(0xc0, 0x00);  // z = -2
  number(0x3f, 0xf0);  // w = 1
  for (int i = 0; i < 3; ++i) number(0x00, 0x00);
  EXPECT_EQ(std::vector<std::uint8_t>(datagram.begin(), datagram.end()), expected);
}

TEST(PoseDatagram, ComesBackAsItWas) {
  const PoseMessage message = message_with_all();
  const auto back = decode_pose_datagram(encode_pose_datagram(message));
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(back->valid);
  EXPECT_EQ(back->sequence, message.sequence);
  EXPECT_EQ(back->time, message.time);
  EXPECT_EQ(back->X_WFt.translation, message.X_WFt.translation);
  EXPECT_LT((back->X_WFt.rotation - message.X_WFt.rotation).norm(), 1e-14);
  PoseMessage lost = message;
  lost.valid = false;
  lost.X_WFt.translation.setConstant(std::nan(""));  // not looked at
  ASSERT_TRUE(decode_pose_datagram(encode_pose_datagram(lost)).has_value());
  EXPECT_FALSE(decode_pose_datagram(encode_pose_datagram(lost))->valid);
}

TEST(PoseDatagram, AnythingElseIsRefused) {
  const PoseDatagram good = encode_pose_datagram(message_with_all());
  const std::vector<std::uint8_t> bytes(good.begin(), good.end());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_pose_datagram(std::span(bytes).first(size))) << size;
  }
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(decode_pose_datagram(longer));
  // Magic, version and the flag's upper bits: every other bit there is wrong.
  for (const std::size_t at : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u, 13u, 14u, 15u}) {
    PoseDatagram bad = good;
    bad[at] ^= 0x10;
    EXPECT_FALSE(decode_pose_datagram(bad)) << at;
  }
  const auto refused = [](auto change) {
    PoseMessage message = message_with_all();
    change(message);
    return !decode_pose_datagram(encode_pose_datagram(message));
  };
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refused([&](PoseMessage& m) { m.X_WFt.translation.y() = nan; }));
  EXPECT_TRUE(refused([&](PoseMessage& m) { m.X_WFt.translation.z() = -infinity; }));
  EXPECT_TRUE(refused([&](PoseMessage& m) { m.X_WFt.translation.x() = 101.0; }));
  EXPECT_TRUE(refused([&](PoseMessage& m) { m.time = nan; }));
  EXPECT_TRUE(refused([&](PoseMessage& m) { m.time = infinity; }));
  EXPECT_TRUE(pose_from_outside({0, 0, 0}, {1.009, 0, 0, 0}));
  EXPECT_FALSE(pose_from_outside({0, 0, 0}, {1.011, 0, 0, 0}));
  EXPECT_FALSE(pose_from_outside({0, 0, 0}, {0, 0, 0, 0}));
  EXPECT_FALSE(pose_from_outside({0, 0, 0}, {nan, 0, 0, 1}));
}

TEST(PoseDatagram, NoiseGivesAPoseThatIsOneOrNone) {
  std::mt19937 random(5);
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    PoseDatagram datagram = encode_pose_datagram(message_with_all());
    for (int flips = 0; flips < 3; ++flips) {
      datagram[random() % datagram.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    }
    const auto message = decode_pose_datagram(datagram);
    if (!message || !message->valid) continue;
    ++accepted;
    ASSERT_TRUE(message->X_WFt.translation.allFinite());
    ASSERT_NEAR(message->X_WFt.rotation.determinant(), 1.0, 1e-9);
  }
  EXPECT_GT(accepted, 1000);
}

}  // namespace
}  // namespace softfinger
