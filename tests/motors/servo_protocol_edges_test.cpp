#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"

namespace softfinger {
namespace {

std::vector<std::unique_ptr<const ServoProtocol>> both_protocols() {
  std::vector<std::unique_ptr<const ServoProtocol>> both;
  both.push_back(std::make_unique<DynamixelProtocol>());
  both.push_back(std::make_unique<FeetechProtocol>());
  return both;
}

TEST(ServoProtocolEdges, AnAnswerKeepsIdErrorAndData) {
  const std::array<std::uint8_t, 4> data{0x12, 0xFF, 0x00, 0xFD};
  for (const auto& protocol : both_protocols()) {
    for (const std::uint8_t error : std::to_array<std::uint8_t>({0, 1, 7})) {
      for (std::size_t size = 0; size <= data.size(); ++size) {
        const auto told = std::span(data).first(size);
        std::array<std::uint8_t, ServoProtocol::kMostBytes> bytes;
        const std::size_t count = protocol->encode(protocol->status_frame(9, error, told), bytes);
        const auto frame = std::span(bytes).first(count);
        ASSERT_EQ(protocol->frame_length(frame), static_cast<int>(count));
        const ServoFrame read = protocol->decode(frame);
        const auto status = protocol->status(read);
        ASSERT_TRUE(status);
        EXPECT_EQ(status->id, 9);
        EXPECT_EQ(status->error, error);
        EXPECT_TRUE(std::ranges::equal(status->data, told));
      }
    }
  }
}

// Anything may follow on the line, and what has come so far may be the beginning.
TEST(ServoProtocolEdges, AFrameIsAsLongAsItIsWhateverFollows) {
  for (const auto& protocol : both_protocols()) {
    std::array<std::uint8_t, ServoProtocol::kMostBytes> bytes{};
    const std::size_t count = protocol->encode(ping_request(3), bytes);
    for (std::size_t come = 0; come < count; ++come) {
      EXPECT_EQ(protocol->frame_length(std::span(bytes).first(come)), 0) << come;
    }
    EXPECT_EQ(protocol->frame_length(std::span(bytes).first(count)), static_cast<int>(count));
    EXPECT_EQ(protocol->frame_length(bytes), static_cast<int>(count));
  }
}

TEST(ServoProtocolEdges, ValuesOfRegistersAreOfOneToFourBytes) {
  const std::array<std::uint8_t, 5> bytes{0x78, 0x56, 0x34, 0x12, 0x99};
  EXPECT_EQ(register_value(std::span(bytes).first(0)), 0U);
  EXPECT_EQ(register_value(std::span(bytes).first(1)), 0x78U);
  EXPECT_EQ(register_value(std::span(bytes).first(2)), 0x5678U);
  EXPECT_EQ(register_value(std::span(bytes).first(4)), 0x12345678U);
  EXPECT_EQ(register_value(bytes), 0x12345678U) << "no more fit";
}

}  // namespace
}  // namespace softfinger
