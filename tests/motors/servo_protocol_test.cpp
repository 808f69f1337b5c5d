// Frames of Dynamixel and Feetech servos: bytes of the manuals' examples, and laws of both.
#include "softfinger/motors/servo_table/servo_protocol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/servo_table/frame_reader.hpp"

namespace softfinger {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encoded(const ServoProtocol& protocol, const ServoFrame& frame) {
  Bytes bytes(ServoProtocol::kMostBytes);
  bytes.resize(protocol.encode(frame, bytes));
  return bytes;
}

std::vector<ServoFrame> frames_in(const ServoProtocol& protocol, const Bytes& bytes) {
  FrameReader reader(protocol);
  std::vector<ServoFrame> frames;
  reader.push(bytes, [&](const ServoFrame& frame) { frames.push_back(frame); });
  return frames;
}

bool same_frame(const ServoFrame& a, const ServoFrame& b) {
  return a.id == b.id && a.code == b.code && a.size == b.size && a.parameters == b.parameters;
}

// "DYNAMIXEL Protocol 2.0", examples of ping, write and sync write.
TEST(DynamixelProtocol, SaysTheExamplesOfTheManual) {
  const DynamixelProtocol protocol;
  EXPECT_EQ(encoded(protocol, ping_request(1)),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x01, 0x19, 0x4E}));
  EXPECT_EQ(encoded(protocol, write_request(protocol, 1, protocol.table().goal, 512)),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x09, 0x00, 0x03, 0x74, 0x00, 0x00, 0x02, 0x00,
                   0x00, 0xCA, 0x89}));
  const std::array<std::uint8_t, 2> ids{1, 2};
  const std::array<std::uint32_t, 2> goals{150, 170};
  EXPECT_EQ(encoded(protocol, sync_write_request(protocol, protocol.table().goal, ids, goals)),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x11, 0x00, 0x83, 0x74, 0x00, 0x04, 0x00,
                   0x01, 0x96, 0x00, 0x00, 0x00, 0x02, 0xAA, 0x00, 0x00, 0x00, 0x82, 0x87}));
}

TEST(DynamixelProtocol, StuffsWhatLooksLikeAHeader) {
  const DynamixelProtocol protocol;
  // The goal FF FF FD 00 low byte first would start a frame inside the frame.
  const ServoFrame frame = write_request(protocol, 1, protocol.table().goal, 0x00FDFFFF);
  const Bytes bytes = encoded(protocol, frame);
  EXPECT_EQ(Bytes(bytes.begin() + 5, bytes.end() - 2),
            (Bytes{0x0A, 0x00, 0x03, 0x74, 0x00, 0xFF, 0xFF, 0xFD, 0xFD, 0x00}));
  const auto frames = frames_in(protocol, bytes);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(same_frame(frames[0], frame));
}

TEST(DynamixelProtocol, AnAlertIsNoError) {
  const DynamixelProtocol protocol;
  const std::array<std::uint8_t, 1> data{7};
  const auto status = protocol.status(protocol.status_frame(3, 0x80, data));
  ASSERT_TRUE(status);
  EXPECT_EQ(status->error, 0);
  EXPECT_EQ(protocol.status(protocol.status_frame(3, 0x84, data))->error, 4);
  EXPECT_FALSE(protocol.status(ping_request(3)));  // an echo of what was sent
}

// "FT-SCS communication protocol", examples of ping, read and write.
TEST(FeetechProtocol, SaysTheExamplesOfTheManual) {
  const FeetechProtocol protocol;
  EXPECT_EQ(encoded(protocol, ping_request(1)), (Bytes{0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB}));
  EXPECT_EQ(encoded(protocol, read_request(protocol, 1, protocol.table().present)),
            (Bytes{0xFF, 0xFF, 0x01, 0x04, 0x02, 0x38, 0x02, 0xBE}));
  // Goal 2048, time 0, speed 1000.
  ServoFrame frame;
  frame.id = 1;
  frame.code = 3;
  for (const int byte : {0x2A, 0x00, 0x08, 0x00, 0x00, 0xE8, 0x03}) {
    frame.add(static_cast<std::uint8_t>(byte));
  }
  EXPECT_EQ(encoded(protocol, frame),
            (Bytes{0xFF, 0xFF, 0x01, 0x09, 0x03, 0x2A, 0x00, 0x08, 0x00, 0x00, 0xE8, 0x03, 0xD5}));
  // The same goal and speed to servos 1 to 4.
  ServoFrame all;
  all.id = kEveryServo;
  all.code = 0x83;
  all.add(0x2A);
  all.add(6);
  for (std::uint8_t id = 1; id <= 4; ++id) {
    all.add(id);
    for (const int byte : {0x00, 0x08, 0x00, 0x00, 0xE8, 0x03}) {
      all.add(static_cast<std::uint8_t>(byte));
    }
  }
  const Bytes bytes = encoded(protocol, all);
  EXPECT_EQ(bytes[3], (6 + 1) * 4 + 4);
  EXPECT_EQ(bytes.back(), 0x58);
}

TEST(FeetechProtocol, PositionsHaveASignBit) {
  const FeetechProtocol protocol;
  EXPECT_EQ(protocol.to_register(-1), 0x8001u);
  EXPECT_EQ(protocol.to_position(0x8001), -1);
  for (std::int32_t position = -32767; position <= 32767; ++position) {
    ASSERT_EQ(protocol.to_position(protocol.to_register(position)), position);
  }
}

class EveryServoProtocol : public testing::TestWithParam<const char*> {
 protected:
  EveryServoProtocol() {
    if (std::string_view(GetParam()) == "dynamixel") {
      protocol_ = std::make_unique<DynamixelProtocol>();
    } else {
      protocol_ = std::make_unique<FeetechProtocol>();
    }
  }
  std::uint8_t byte() {
    // Often those that headers are made of.
    constexpr std::array<std::uint8_t, 5> kTelling{0xFF, 0xFF, 0xFD, 0xFD, 0x00};
    const auto pick = static_cast<std::size_t>(random_() % 8);
    return pick < kTelling.size() ? kTelling[pick] : static_cast<std::uint8_t>(random_());
  }
  ServoFrame any_frame() {
    ServoFrame frame;
    frame.id = static_cast<std::uint8_t>(random_() % 0xFD);
    frame.code = byte();
    const auto size = random_() % 60;
    for (std::uint64_t i = 0; i < size; ++i) frame.add(byte());
    return frame;
  }

  std::unique_ptr<const ServoProtocol> protocol_;
  std::mt19937_64 random_{11};
};

TEST_P(EveryServoProtocol, ReadsWhatItWrites) {
  for (int i = 0; i < 3000; ++i) {
    const ServoFrame frame = any_frame();
    const auto frames = frames_in(*protocol_, encoded(*protocol_, frame));
    ASSERT_EQ(frames.size(), 1u);
    ASSERT_TRUE(same_frame(frames[0], frame));
  }
}

TEST_P(EveryServoProtocol, RefusesEveryWrongByte) {
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    const Bytes good = encoded(*protocol_, any_frame());
    for (std::size_t at = 0; at < good.size(); ++at) {
      Bytes bad = good;
      bad[at] = static_cast<std::uint8_t>(bad[at] ^ (1 + random_() % 255));
      // Bytes inside may happen to be a shorter frame of their own; the whole never is one.
      ASSERT_LE(protocol_->frame_length(bad), static_cast<int>(bad.size()) - 1) << at;
      ++refused;
    }
  }
  EXPECT_GT(refused, 3000);
}

TEST_P(EveryServoProtocol, FindsFramesAfterNoiseAndHalfFrames) {
  int found = 0;
  for (int i = 0; i < 500; ++i) {
    const ServoFrame frame = any_frame();
    Bytes bytes;
    const auto noise = random_() % 40;
    for (std::uint64_t k = 0; k < noise; ++k) bytes.push_back(byte());
    const Bytes half = encoded(*protocol_, any_frame());
    bytes.insert(bytes.end(), half.begin(), half.begin() + static_cast<long>(half.size() / 2));
    const Bytes whole = encoded(*protocol_, frame);
    bytes.insert(bytes.end(), whole.begin(), whole.end());
    // What looks like a long frame is given up once it is complete, and wrong.
    for (std::size_t k = 0; k < ServoProtocol::kMostBytes; ++k) bytes.push_back(0x11);
    const auto frames = frames_in(*protocol_, bytes);
    found += std::any_of(frames.begin(), frames.end(),
                         [&](const ServoFrame& one) { return same_frame(one, frame); });
  }
  // Noise that begins like a frame has a right checksum of 8 bits once in 256 times.
  EXPECT_GE(found, 485);
}

TEST_P(EveryServoProtocol, CountsEveryByteOnce) {
  FrameReader reader(*protocol_);
  std::size_t in_frames = 0;
  Bytes noise;
  for (int i = 0; i < 20000; ++i) noise.push_back(byte());
  reader.push(noise, [&](const ServoFrame& frame) {
    in_frames += encoded(*protocol_, frame).size();
    ASSERT_LE(frame.size, ServoFrame::kMostParameters);
  });
  EXPECT_EQ(reader.bytes(), noise.size());
  EXPECT_LE(reader.malformed_bytes() + in_frames, noise.size());
  EXPECT_GE(reader.malformed_bytes() + in_frames + ServoProtocol::kMostBytes, noise.size());
}

INSTANTIATE_TEST_SUITE_P(Families, EveryServoProtocol, testing::Values("dynamixel", "feetech"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace softfinger
