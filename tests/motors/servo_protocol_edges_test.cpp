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

/// A whole Dynamixel frame with so many parameters, all 0, its checksum right.
std::vector<std::uint8_t> dynamixel_frame_of(std::size_t parameters) {
  const std::size_t length = parameters + 3;
  std::vector<std::uint8_t> bytes{0xFF,
                                  0xFF,
                                  0xFD,
                                  0x00,
                                  1,
                                  static_cast<std::uint8_t>(length & 0xFF),
                                  static_cast<std::uint8_t>(length >> 8),
                                  0x03};
  bytes.resize(bytes.size() + parameters);
  const std::uint16_t crc = dynamixel_crc(bytes);
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8));
  return bytes;
}

TEST(ServoProtocolEdges, AFrameOfMoreParametersThanFitIsNone) {
  const DynamixelProtocol protocol;
  const auto most = dynamixel_frame_of(ServoFrame::kMostParameters);
  ASSERT_EQ(protocol.frame_length(most), static_cast<int>(most.size()));
  EXPECT_EQ(protocol.decode(most).size, ServoFrame::kMostParameters);
  EXPECT_EQ(protocol.frame_length(dynamixel_frame_of(ServoFrame::kMostParameters + 1)), -1);
}

TEST(ServoProtocolEdges, SoMuchAndNoMoreFitsIntoAFrameOfFeetech) {
  const FeetechProtocol protocol;
  ServoFrame frame{.id = 1, .code = 3};
  for (std::size_t i = 0; i < ServoFrame::kMostParameters; ++i) frame.add(0);
  std::array<std::uint8_t, ServoProtocol::kMostBytes> bytes;
  const std::size_t size = protocol.encode(frame, bytes);
  EXPECT_EQ(protocol.frame_length(std::span(bytes).first(size)), static_cast<int>(size));
  ++bytes[3];
  EXPECT_EQ(protocol.frame_length(bytes), -1) << "one more";
}

TEST(ServoProtocolEdges, WhatIsNoAnswerIsNone) {
  EXPECT_FALSE(DynamixelProtocol().status({.id = 1, .code = 0x55})) << "says not even its error";
  EXPECT_FALSE(DynamixelProtocol().status(ping_request(1))) << "a question";
  EXPECT_FALSE(FeetechProtocol().status({.id = kEveryServo, .code = 0})) << "of all servos at once";
}

TEST(ServoProtocolEdges, AHeaderInsideThatIsNotStuffedMakesAFrameNone) {
  const DynamixelProtocol protocol;
  const auto with = [](std::vector<std::uint8_t> parameters) {
    std::vector<std::uint8_t> bytes = dynamixel_frame_of(parameters.size());
    std::ranges::copy(parameters, bytes.begin() + 8);
    const std::size_t end = bytes.size() - 2;
    const std::uint16_t crc = dynamixel_crc(std::span(bytes).first(end));
    bytes[end] = static_cast<std::uint8_t>(crc & 0xFF);
    bytes[end + 1] = static_cast<std::uint8_t>(crc >> 8);
    return bytes;
  };
  const auto stuffed = with({0xFF, 0xFF, 0xFD, 0xFD, 0x01});
  EXPECT_EQ(protocol.frame_length(stuffed), static_cast<int>(stuffed.size()));
  EXPECT_EQ(protocol.decode(stuffed).size, 4U);
  EXPECT_EQ(protocol.frame_length(with({0xFF, 0xFF, 0xFD, 0x00, 0x01})), -1);
  EXPECT_EQ(protocol.frame_length(with({0x01, 0xFF, 0xFF, 0xFD})), -1) << "at the end";
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
