#include "softfinger/motors/maestro/maestro_protocol.hpp"

#include <gmock/gmock.h>

#include <array>
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

// Section 5.d of the same, and a command of 5.e.
TEST(MaestroProtocol, GoldenChecksums) {
  EXPECT_EQ(maestro_crc(std::array<std::uint8_t, 2>{0x83, 0x01}), 0x17);
  EXPECT_EQ(maestro_crc(std::array<std::uint8_t, 4>{0x84, 0x00, 0x70, 0x2E}), 0x2B);
}

// A CRC of seven bits leaves no burst of up to seven wrong ones unseen; where the bit that begins a
// command is among them, another command may begin.
TEST(MaestroProtocol, WithChecksumsNoBurstOfWrongBitsIsObeyed) {
  const std::vector<std::vector<int>> commands{{0x84, 3, 0x70, 0x2E},
                                               {0x90, 5},
                                               {0xA1},
                                               {0x9F, 2, 3, 0, 0, 0x70, 0x2E},
                                               {0xAA, 12, 4, 1, 0x70, 0x2E}};
  int tried = 0;
  for (const auto& command : commands) {
    std::vector<std::uint8_t> bytes(command.begin(), command.end());
    bytes.push_back(maestro_crc(bytes));
    const auto requests = [](const std::vector<std::uint8_t>& sent) {
      MaestroDecoder decoder(true);
      return decode(decoder, {sent.begin(), sent.end()}).size();
    };
    ASSERT_EQ(requests(bytes), 1U);
    for (std::size_t first = 0; first < 8 * bytes.size(); ++first) {
      for (unsigned burst = 1; burst < 128; burst += 2) {
        std::vector<std::uint8_t> wrong = bytes;
        bool begins = false;
        for (std::size_t bit = 0; bit < 7 && first + bit < 8 * bytes.size(); ++bit) {
          if (((burst >> bit) & 1U) == 0) continue;
          begins = begins || (first + bit) % 8 == 7;
          wrong[(first + bit) / 8] ^= static_cast<std::uint8_t>(1U << ((first + bit) % 8));
        }
        if (begins) continue;
        ++tried;
        EXPECT_EQ(requests(wrong), 0U) << command[0] << " bit " << first << " burst " << burst;
      }
    }
  }
  EXPECT_GT(tried, 5000);
}

TEST(MaestroProtocol, WithChecksumsItGoesOnAfterAWrongOne) {
  MaestroDecoder decoder(true);
  EXPECT_EQ(decode(decoder, {0x84, 0, 0x70, 0x2E, 0x2A}).size(), 0U);
  EXPECT_EQ(decoder.crc_errors(), 1U);
  EXPECT_EQ(decode(decoder, {0x84, 0, 0x70, 0x2E}).size(), 0U);
  EXPECT_EQ(decode(decoder, {0x2B}).size(), 1U);
  EXPECT_EQ(decode(decoder, {0x84, 0, 0x70, 0x84, 0, 0x70, 0x2E, 0x2B}).size(), 1U);
  EXPECT_EQ(decoder.crc_errors(), 1U);
  EXPECT_EQ(decoder.malformed_bytes(), 3U);
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
           {0xAA, 0x0C, 0x04, 0x01, 0x70},
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
