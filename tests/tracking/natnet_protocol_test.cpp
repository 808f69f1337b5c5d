#include "softfinger/tracking/natnet/natnet_protocol.hpp"

#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <random>
#include <string>
#include <string_view>

#include "softfinger/tracking/natnet/natnet_encoding.hpp"

namespace softfinger {
namespace {

NatNetDatagram from_hex(std::string_view text) {
  NatNetDatagram bytes;
  std::string digits;
  for (const char c : text) {
    if (c != ' ') digits += c;
  }
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    std::uint8_t byte = 0;
    std::from_chars(digits.data() + i, digits.data() + i + 2, byte, 16);
    bytes.push_back(byte);
  }
  return bytes;
}

/// Written by natnet_py and read back by python-natnet-client: rigid body 7 at (0.1, 1.2, -0.3),
/// identity, mean error 0.0005, tracked; frame 42, timestamp 12.5, stamps 1000, 2000, 3000.
const NatNetDatagram kGoldenFrame = from_hex(
    "07007400 2a000000 00000000 00000000 01000000 07000000 cdcccc3d 9a99993f 9a9999be 00000000 "
    "00000000 00000000 0000803f 6f12033a 0100 00000000 00000000 00000000 00000000 00000000 "
    "00000000 "
    "0000000000002940 e803000000000000 d007000000000000 b80b000000000000 0000 00000000");
/// The same two: NatNet 3.1, one body "index_tip", id 7, no parent.
const NatNetDatagram kGoldenModels = from_hex(
    "05002a00 01000000 01000000 696e6465785f74697000 07000000 ffffffff 00000000 00000000 00000000 "
    "00000000");

std::optional<NatNetFrame> decode(const NatNetDatagram& datagram, NatNetVersion version,
                                  std::int32_t body) {
  const auto packet = open_natnet(datagram);
  if (!packet || packet->message != NatNetMessage::kFrame) return std::nullopt;
  return decode_natnet_frame(packet->payload, version, body);
}

NatNetDatagram frame_of(NatNetVersion version, bool everything, const Pose& pose, bool tracked) {
  const std::array<NatNetBodyPose, 3> bodies{
      NatNetBodyPose{.id = 3, .X_KBody = {}, .tracked = true},
      NatNetBodyPose{.id = -7, .X_KBody = pose, .tracked = tracked},
      NatNetBodyPose{.id = 8, .X_KBody = {}, .tracked = false}};
  return encode_natnet_frame({.number = 1234567,
                              .bodies = bodies,
                              .time = 2.5,
                              .mid_exposure = 0x123456789abcdef0,
                              .models_changed = tracked,
                              .version_changed = !tracked,
                              .with_all_sections = everything},
                             version);
}

TEST(NatNetProtocol, ReadsAndWritesTheGoldenFrame) {
  ASSERT_EQ(kGoldenFrame.size(), 120u);
  for (const NatNetVersion version : {NatNetVersion{3, 1}, NatNetVersion{4, 0}}) {
    const auto frame = decode(kGoldenFrame, version, 7);
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->number, 42);
    ASSERT_TRUE(frame->has_body);
    EXPECT_TRUE(frame->tracked);
    EXPECT_LT((frame->position - Vector3(0.1, 1.2, -0.3)).norm(), 1e-7);
    EXPECT_EQ(frame->rotation.coeffs(), Eigen::Vector4d(0, 0, 0, 1));
    EXPECT_EQ(frame->mid_exposure, 1000u);
    EXPECT_FALSE(frame->models_changed);
    EXPECT_FALSE(decode(kGoldenFrame, version, 6)->has_body);
    const std::array<NatNetBodyPose, 1> body{
        NatNetBodyPose{.id = 7, .X_KBody = {Matrix3::Identity(), {0.1, 1.2, -0.3}}}};
    EXPECT_EQ(encode_natnet_frame({.number = 42,
                                   .bodies = body,
                                   .time = 12.5,
                                   .mid_exposure = 1000,
                                   .received = 2000,
                                   .transmitted = 3000,
                                   .mean_error = 0.0005},
                                  version),
              kGoldenFrame);
  }
}

TEST(NatNetProtocol, ReadsAndWritesTheGoldenModels) {
  ASSERT_EQ(kGoldenModels.size(), 46u);
  const auto packet = open_natnet(kGoldenModels);
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->message, NatNetMessage::kModels);
  const auto bodies = decode_natnet_models(packet->payload, {3, 1});
  ASSERT_TRUE(bodies.has_value());
  ASSERT_EQ(bodies->size(), 1u);
  EXPECT_EQ(bodies->front().id, 7);
  EXPECT_EQ(bodies->front().name, "index_tip");
  EXPECT_EQ(encode_natnet_models(*bodies, {3, 1}, false), kGoldenModels);
}

TEST(NatNetProtocol, ServerTellsVersionClockAndWhereFramesGo) {
  const NatNetServer server{.name = "Motive",
                            .version = {4, 1},
                            .ticks_per_second = 10'000'000,
                            .data_port = 1511,
                            .multicast = true,
                            .group = kNatNetGroup};
  const NatNetDatagram datagram = encode_natnet_server(server);
  const auto packet = open_natnet(datagram);
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->payload.size(), 279u) << "as every description of SERVERINFO says";
  EXPECT_EQ(packet->payload[277], 42) << "239.255.42.99, in this order";
  const auto back = decode_natnet_server(packet->payload);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->name, "Motive");
  EXPECT_EQ(back->version, server.version);
  EXPECT_EQ(back->ticks_per_second, server.ticks_per_second);
  EXPECT_EQ(back->data_port, 1511);
  EXPECT_TRUE(back->multicast);
  EXPECT_EQ(back->group, kNatNetGroup);
  for (std::size_t size = 0; size < packet->payload.size(); ++size) {
    EXPECT_FALSE(decode_natnet_server(packet->payload.first(size))) << size;
  }
}

TEST(NatNetProtocol, ClientMessagesHaveTheirBytes) {
  const NatNetDatagram connect = encode_natnet_connect();
  ASSERT_EQ(connect.size(), 4u + 264u);
  EXPECT_EQ(connect[2] + 256 * connect[3], 264);
  EXPECT_EQ(connect[264], 4);  // NatNet 4.2
  EXPECT_EQ(connect[265], 2);
  EXPECT_EQ(encode_natnet_request(NatNetMessage::kRequestModels), from_hex("04000000"));
  EXPECT_EQ(encode_natnet_request(NatNetMessage::kKeepAlive), from_hex("0a000000"));
  EXPECT_EQ(encode_natnet_request(NatNetMessage::kRequest, "Bitstream,4.2"),
            from_hex("02000e00 42697473747265616d2c342e3200"));
  EXPECT_EQ(encode_natnet_echo_request(0x0102030405060708), from_hex("0c000800 0807060504030201"));
}

class EveryVersion : public testing::TestWithParam<NatNetVersion> {};

TEST_P(EveryVersion, FramesComeBackWithAndWithoutOtherSections) {
  const Pose pose{exp_rotation({0.5, -1.0, 0.25}), {0.125, -2.5, 3.75}};
  for (const bool everything : {false, true}) {
    for (const bool tracked : {false, true}) {
      const auto frame = decode(frame_of(GetParam(), everything, pose, tracked), GetParam(), -7);
      ASSERT_TRUE(frame.has_value());
      EXPECT_EQ(frame->number, 1234567);
      ASSERT_TRUE(frame->has_body);
      EXPECT_EQ(frame->tracked, tracked);
      EXPECT_EQ(frame->position, pose.translation);
      EXPECT_LT((frame->rotation.toRotationMatrix() - pose.rotation).norm(), 1e-6);
      EXPECT_EQ(frame->mid_exposure, 0x123456789abcdef0u);
      EXPECT_EQ(frame->models_changed, tracked);
      EXPECT_EQ(frame->version_changed, !tracked);
    }
  }
}

TEST_P(EveryVersion, AFrameMayHaveAPrecisionTime) {
  NatNetDatagram datagram = frame_of(GetParam(), true, {}, true);
  datagram.insert(datagram.end() - 6, 8, 0xff);
  datagram[2] = static_cast<std::uint8_t>(datagram.size() - 4);
  datagram[3] = static_cast<std::uint8_t>((datagram.size() - 4) >> 8);
  const auto frame = decode(datagram, GetParam(), -7);
  ASSERT_TRUE(frame.has_value());
  EXPECT_TRUE(frame->models_changed);
  EXPECT_FALSE(frame->version_changed);
}

TEST_P(EveryVersion, ModelsComeBackFromAmongOtherThings) {
  const std::vector<NatNetBody> bodies{{1, "thumb"}, {-3, ""}, {70000, "index finger"}};
  for (const bool everything : {false, true}) {
    const NatNetDatagram datagram = encode_natnet_models(bodies, GetParam(), everything);
    const auto back = decode_natnet_models(open_natnet(datagram)->payload, GetParam());
    ASSERT_TRUE(back.has_value());
    ASSERT_EQ(back->size(), bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      EXPECT_EQ((*back)[i].id, bodies[i].id);
      EXPECT_EQ((*back)[i].name, bodies[i].name);
    }
  }
}

TEST_P(EveryVersion, CutFramesAreRefused) {
  const NatNetDatagram datagram = frame_of(GetParam(), true, {}, true);
  const auto payload = open_natnet(datagram)->payload;
  for (std::size_t size = 0; size < payload.size(); ++size) {
    EXPECT_FALSE(decode_natnet_frame(payload.first(size), GetParam(), -7)) << size;
    EXPECT_FALSE(open_natnet(std::span(datagram).first(4 + size))) << size;
  }
}

// Every count and size from outside may be anything: nothing is read past the end (the sanitizers
// look), and nothing is larger than the bytes that came.
TEST_P(EveryVersion, NoiseIsSurvived) {
  std::mt19937 random(GetParam().major * 16u + GetParam().minor);
  const std::vector<NatNetBody> bodies{{1, "thumb"}, {2, "index"}};
  const NatNetDatagram frame = frame_of(GetParam(), true, {}, true);
  const NatNetDatagram models = encode_natnet_models(bodies, GetParam(), true);
  for (int i = 0; i < 20000; ++i) {
    NatNetDatagram noisy = i % 2 == 0 ? frame : models;
    if (i % 16 == 15) {
      noisy.resize(random() % 300);
      for (std::uint8_t& byte : noisy) byte = static_cast<std::uint8_t>(random());
    }
    for (int change = 0; change < 3 && !noisy.empty(); ++change) {
      const std::array<std::uint8_t, 4> values{0, 1, 0x7f, 0xff};
      noisy[random() % noisy.size()] = values[random() % values.size()];
    }
    const auto payload = std::span<const std::uint8_t>(noisy);
    const auto read = decode_natnet_frame(payload, GetParam(), -7);
    ASSERT_TRUE(!read || payload.size() >= 78u) << "shorter than the shortest frame";
    if (const auto found = decode_natnet_models(payload, GetParam())) {
      std::size_t size = 0;
      for (const NatNetBody& body : *found) size += 4 + body.name.size();
      ASSERT_LE(size, payload.size());
    }
    (void)decode_natnet_server(payload);
    (void)decode_natnet_echo(payload);
  }
}

INSTANTIATE_TEST_SUITE_P(NatNet, EveryVersion,
                         testing::Values(NatNetVersion{3, 0}, NatNetVersion{3, 1},
                                         NatNetVersion{4, 0}, NatNetVersion{4, 1},
                                         NatNetVersion{4, 2}),
                         [](const auto& version) {
                           return "V" + std::to_string(version.param.major) + "_" +
                                  std::to_string(version.param.minor);
                         });

}  // namespace
}  // namespace softfinger
