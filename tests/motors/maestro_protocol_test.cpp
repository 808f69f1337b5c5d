#include "softfinger/motors/maestro/maestro_protocol.hpp"

#include <gmock/gmock.h>

#include <random>
#include <vector>

namespace softfinger {
namespace {

using testing::ElementsAre;

std::vector<MaestroRequest> decode(MaestroDecoder& decoder, const std::vector<int>& bytes) {
  std::vector<MaestroRequest> requests;
  for (const int byte : bytes) {
    if (const auto request = decoder.push(static_cast<std::uint8_t>(byte))) {
      requests.push_back(*request);
    }
  }
  return requests;
}

// Byte examples of the Maestro User's Guide, sections 5.c and 5.e.
TEST(MaestroProtocol, GoldenBytes) {
  EXPECT_THAT(encode_set_target(0, 6000), ElementsAre(0x84, 0x00, 0x70, 0x2E));
  EXPECT_THAT(encode_set_target(2, 6000), ElementsAre(0x84, 0x02, 0x70, 0x2E));
  EXPECT_THAT(encode_set_speed(5, 140), ElementsAre(0x87, 0x05, 0x0C, 0x01));
  EXPECT_THAT(encode_set_acceleration(5, 4), ElementsAre(0x89, 0x05, 0x04, 0x00));
  EXPECT_THAT(encode_get_position(5), ElementsAre(0x90, 0x05));
  EXPECT_EQ(encode(MaestroCommand::kGetMovingState), 0x93);
  EXPECT_EQ(encode(MaestroCommand::kGetErrors), 0xA1);
  EXPECT_EQ(encode(MaestroCommand::kGoHome), 0xA2);
  EXPECT_EQ(decode_reply(0x70, 0x17), 6000);
}

TEST(MaestroProtocol, DecodesWhatItEncodes) {
  MaestroDecoder decoder;
  for (int channel = 0; channel < kMaestroChannels; ++channel) {
    for (const int target : {0, 1, 127, 128, 6000, 16383}) {
      std::optional<MaestroRequest> request;
      for (const auto byte : encode_set_target(channel, static_cast<std::uint16_t>(target))) {
        EXPECT_FALSE(request);
        request = decoder.push(byte);
      }
      ASSERT_TRUE(request);
      EXPECT_EQ(request->command, MaestroCommand::kSetTarget);
      EXPECT_EQ(request->channel, channel);
      EXPECT_EQ(request->values[0], target);
    }
  }
  const auto several = decode(decoder, {0x9F, 2, 3, 0, 0, 0x70, 0x2E});
  ASSERT_EQ(several.size(), 1u);
  EXPECT_EQ(several[0].channel, 3);
  EXPECT_EQ(several[0].count, 2);
  EXPECT_EQ(several[0].values[1], 6000);
  EXPECT_EQ(decoder.malformed_bytes(), 0u);
}

TEST(MaestroProtocol, DecodesThePololuForm) {
  MaestroDecoder decoder;
  const auto requests = decode(decoder, {0xAA, 0x0C, 0x04, 0x00, 0x70, 0x2E, 0xAA, 0x0C, 0x13});
  ASSERT_EQ(requests.size(), 2u);
  EXPECT_EQ(requests[0].command, MaestroCommand::kSetTarget);
  EXPECT_EQ(requests[0].values[0], 6000);
  EXPECT_EQ(requests[1].command, MaestroCommand::kGetMovingState);
  EXPECT_EQ(decoder.malformed_bytes(), 0u);
}

TEST(MaestroProtocol, FindsItsWayAfterBrokenCommands) {
  MaestroDecoder decoder;
  const std::vector<int> good{0x84, 0x01, 0x70, 0x2E};
  for (const std::vector<int>& broken : std::vector<std::vector<int>>{
           {0x84, 0x00, 0x70},        // cut short
           {0x12, 0x34},              // data without command
           {0xFE},                    // no such command
           {0x84, 0x7F, 0x00, 0x00},  // no such channel
           {0x9F, 0x00},              // no targets
           {0x9F, 0x19},              // more targets than channels
           {0x9F, 0x02, 0x17, 0, 0, 0, 0},
           {0xAA},
           {0xAA, 0x0C},
       }) {
    const auto before = decoder.malformed_bytes();
    EXPECT_TRUE(decode(decoder, broken).empty());
    const auto requests = decode(decoder, good);
    ASSERT_EQ(requests.size(), 1u);
    EXPECT_EQ(requests[0].channel, 1);
    EXPECT_EQ(decoder.malformed_bytes() - before, broken.size());
  }
}

TEST(MaestroProtocol, AnyBytesLeaveAnAccount) {
  MaestroDecoder decoder;
  std::mt19937 random(7);
  std::uint64_t good = 0;
  for (int i = 0; i < 200000; ++i) {
    const auto request = decoder.push(static_cast<std::uint8_t>(random() & 0xFF));
    if (!request) continue;
    EXPECT_GE(request->channel, 0);
    EXPECT_LE(request->channel + request->count, kMaestroChannels);
    ++good;
  }
  EXPECT_GT(good, 0u);
  EXPECT_EQ(decoder.bytes(), 200000u);
  EXPECT_LT(decoder.malformed_bytes(), 200000u);
}

}  // namespace
}  // namespace softfinger
