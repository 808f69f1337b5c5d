#include "softfinger/tracking/stream/osc_pose.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace softfinger {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes text(std::string_view characters) { return {characters.begin(), characters.end()}; }

Bytes element(const Bytes& packet) {
  return Bytes{0, 0, static_cast<std::uint8_t>(packet.size() >> 8),
               static_cast<std::uint8_t>(packet.size())} +
         packet;
}

Bytes bundle(const Bytes& elements) {
  return text({"#bundle\0", 8}) + Bytes{0, 0, 0, 0, 0, 0, 0, 1} + elements;
}

const Pose kPose{exp_rotation({0.1, 0.2, -0.4}), {0.01, -0.02, 0.03}};

/// OSC 1.0: "/a" with one float32, 1.0.
const Bytes kOther{0x2f, 0x61, 0, 0, 0x2c, 0x66, 0, 0, 0x3f, 0x80, 0, 0};

void expect_pose(const std::optional<PoseMessage>& message, const Pose& pose, double tolerance) {
  ASSERT_TRUE(message.has_value());
  EXPECT_LT((message->X_WFt.translation - pose.translation).norm(), tolerance);
  EXPECT_LT((message->X_WFt.rotation - pose.rotation).norm(), tolerance);
}

TEST(OscPose, ReadsTheBytesOfOsc) {
  const Bytes message = text({"/finger/pose\0\0\0\0,fffffff\0\0\0\0", 28}) +
                        Bytes{0x3f, 0x80, 0, 0, 0x40, 0, 0, 0, 0xbf, 0, 0, 0,  // 1, 2, -0.5
                              0,    0,    0, 0, 0,    0, 0, 0, 0,    0, 0, 0, 0x3f, 0x80, 0, 0};
  Pose pose;
  pose.translation = {1.0, 2.0, -0.5};
  pose.rotation.diagonal() << -1.0, -1.0, 1.0;  // half a turn about z
  expect_pose(decode_osc_pose(message), pose, 1e-12);
}

TEST(OscPose, ComesBackAsItWas) {
  expect_pose(decode_osc_pose(encode_osc_pose(kPose, true)), kPose, 1e-14);
  expect_pose(decode_osc_pose(encode_osc_pose(kPose, false)), kPose, 1e-6);
}

TEST(OscPose, IsFoundInBundlesAndTheLastCounts) {
  Pose other = kPose;
  other.translation.x() = 0.5;
  const Bytes first = element(encode_osc_pose(kPose, true));
  const Bytes last = element(encode_osc_pose(other, false));
  expect_pose(decode_osc_pose(bundle(element(kOther) + first)), kPose, 1e-14);
  expect_pose(decode_osc_pose(bundle(first + element(bundle(last)) + element(kOther))), other,
              1e-6);
  EXPECT_FALSE(decode_osc_pose(kOther));
  EXPECT_FALSE(decode_osc_pose(bundle({})));
  Bytes deep = encode_osc_pose(kPose, true);
  for (int depth = 0; depth < 4; ++depth) deep = bundle(element(deep));
  EXPECT_TRUE(decode_osc_pose(deep));
  EXPECT_FALSE(decode_osc_pose(bundle(element(deep))));
}

TEST(OscPose, OtherMessagesMayHaveEveryArgument) {
  const Bytes rich = text({"/all\0\0\0\0,ifsbhtdTFNI\0\0\0\0", 24}) + Bytes(8) +
                     text({"abc\0", 4}) + Bytes{0, 0, 0, 5, 1, 2, 3, 4, 5, 0, 0, 0} + Bytes(24);
  expect_pose(decode_osc_pose(bundle(element(rich) + element(encode_osc_pose(kPose, true)))), kPose,
              1e-14);
  EXPECT_FALSE(
      decode_osc_pose(bundle(element(rich + Bytes(4)) + element(encode_osc_pose(kPose, true)))));
}

TEST(OscPose, WhatBreaksTheFormatIsRefusedWhole) {
  const Bytes good = encode_osc_pose(kPose, true);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(decode_osc_pose(std::span(good).first(size))) << size;
  }
  EXPECT_FALSE(decode_osc_pose(good + Bytes(4)));
  // A bundle whose second element says that it is longer than the packet, or negative.
  for (const std::uint8_t size : Bytes{0x7f, 0xff}) {
    EXPECT_FALSE(decode_osc_pose(bundle(element(good) + Bytes{size, 0xff, 0xff, 0xfc} + kOther)));
  }
  Bytes types = good;
  types[17] = 'f';  // ,fdddddd
  EXPECT_FALSE(decode_osc_pose(types));
  Bytes padding = good;
  padding[15] = 'x';
  EXPECT_FALSE(decode_osc_pose(padding));
  Bytes number = good;
  number[28] = 0x7f;  // x = nan
  number[29] = 0xff;
  EXPECT_FALSE(decode_osc_pose(number));
}

TEST(OscPose, NoiseGivesAPoseThatIsOneOrNone) {
  std::mt19937 random(7);
  const Bytes packet = bundle(element(kOther) + element(encode_osc_pose(kPose, false)) +
                              element(bundle(element(encode_osc_pose(kPose, true)))));
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes noisy = packet;
    for (int flips = 0; flips < 2; ++flips) {
      noisy[random() % noisy.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    }
    const auto message = decode_osc_pose(noisy);
    if (!message) continue;
    ++accepted;
    ASSERT_TRUE(message->X_WFt.translation.allFinite());
    ASSERT_NEAR(message->X_WFt.rotation.determinant(), 1.0, 1e-9);
  }
  EXPECT_GT(accepted, 1000);
}

}  // namespace
}  // namespace softfinger
