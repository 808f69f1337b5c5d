// Frames and control tables of Dynamixel and Feetech servos, as their manuals have them, written
// out a second time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <random>
#include <vector>

#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/servo_faults.hpp"

namespace softfinger {
namespace {

using FrameBytes = std::vector<std::uint8_t>;

/// "DYNAMIXEL Protocol 2.0": remainder of the bytes, followed by 16 zero bits, divided by
/// x^16 + x^15 + x^2 + 1.
std::uint16_t remainder_of(const FrameBytes& bytes) {
  std::vector<bool> bits;
  for (const std::uint8_t byte : bytes) {
    for (int k = 7; k >= 0; --k) bits.push_back(((byte >> k) & 1) != 0);
  }
  bits.resize(bits.size() + 16);
  for (std::size_t at = 0; at + 16 < bits.size(); ++at) {
    if (!bits[at]) continue;
    for (const std::size_t power : {16U, 15U, 2U, 0U}) bits[at + 16 - power].flip();
  }
  std::uint16_t rest = 0;
  for (std::size_t at = bits.size() - 16; at < bits.size(); ++at) {
    rest = static_cast<std::uint16_t>((rest << 1) | (bits[at] ? 1 : 0));
  }
  return rest;
}

FrameBytes with_crc(FrameBytes bytes) {
  const std::uint16_t crc = remainder_of(bytes);
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8));
  return bytes;
}

/// The whole frame around a body, whatever it is: instruction and parameters, stuffed or not.
FrameBytes dynamixel_frame(std::uint8_t id, const FrameBytes& body) {
  const std::size_t length = body.size() + 2;
  FrameBytes bytes{0xFF,
                   0xFF,
                   0xFD,
                   0x00,
                   id,
                   static_cast<std::uint8_t>(length & 0xFF),
                   static_cast<std::uint8_t>(length >> 8)};
  bytes.insert(bytes.end(), body.begin(), body.end());
  return with_crc(bytes);
}

FrameBytes stuffed(const FrameBytes& body) {
  constexpr std::array<std::uint8_t, 3> kHeader{0xFF, 0xFF, 0xFD};
  FrameBytes out;
  auto from = body.begin();
  while (true) {
    const auto found = std::search(from, body.end(), kHeader.begin(), kHeader.end());
    if (found == body.end()) break;
    out.insert(out.end(), from, found + 3);
    out.push_back(0xFD);
    from = found + 3;
  }
  out.insert(out.end(), from, body.end());
  return out;
}

FrameBytes feetech_frame(std::uint8_t id, const FrameBytes& body) {
  FrameBytes bytes{0xFF, 0xFF, id, static_cast<std::uint8_t>(body.size() + 1)};
  bytes.insert(bytes.end(), body.begin(), body.end());
  int sum = 0;
  for (std::size_t k = 2; k < bytes.size(); ++k) sum += bytes[k];
  bytes.push_back(static_cast<std::uint8_t>(255 - sum % 256));
  return bytes;
}

struct FamilyOfServos {
  std::unique_ptr<const ServoProtocol> protocol;
  FrameBytes (*frame)(std::uint8_t id, const FrameBytes& body);
};

std::vector<FamilyOfServos> families() {
  std::vector<FamilyOfServos> both;
  both.push_back(
      {std::make_unique<DynamixelProtocol>(),
       [](std::uint8_t id, const FrameBytes& body) { return dynamixel_frame(id, stuffed(body)); }});
  both.push_back({std::make_unique<FeetechProtocol>(), feetech_frame});
  return both;
}

class ServoFrames : public testing::Test {
 protected:
  /// Mostly what headers are made of.
  std::uint8_t byte() {
    constexpr std::array<std::uint8_t, 6> kTelling{0xFF, 0xFF, 0xFF, 0xFD, 0xFD, 0x00};
    const auto pick = static_cast<std::size_t>(random_() % 8);
    return pick < kTelling.size() ? kTelling[pick] : static_cast<std::uint8_t>(random_());
  }
  FrameBytes body_of(std::size_t size) {
    FrameBytes body(size);
    std::generate(body.begin(), body.end(), [this] { return byte(); });
    return body;
  }
  static ServoFrame frame_of(std::uint8_t id, const FrameBytes& body) {
    ServoFrame frame{.id = id, .code = body.front()};
    for (std::size_t k = 1; k < body.size(); ++k) frame.add(body[k]);
    return frame;
  }

  std::mt19937_64 random_{31};
};

TEST_F(ServoFrames, AreThoseOfTheManualsWhateverTheBufferHeld) {
  for (const auto& [protocol, frame] : families()) {
    for (int trial = 0; trial < 2000; ++trial) {
      const auto id = static_cast<std::uint8_t>(random_() % 0xFD);
      const FrameBytes body = body_of(1 + random_() % 60);
      FrameBytes out(ServoProtocol::kMostBytes, byte());
      out.resize(protocol->encode(frame_of(id, body), out));
      ASSERT_EQ(out, frame(id, body));
    }
  }
}

// Nor may what follows it in memory be looked at: it has not come.
TEST_F(ServoFrames, MayStillComeWhereTheyHaveBegun) {
  for (const auto& [protocol, frame] : families()) {
    for (int trial = 0; trial < 300; ++trial) {
      const FrameBytes whole =
          frame(static_cast<std::uint8_t>(random_() % 0xFD), body_of(1 + random_() % 20));
      for (std::size_t come = 0; come < whole.size(); ++come) {
        for (const int other : {0x00, 0xFF, 0xFD}) {
          FrameBytes memory(ServoProtocol::kMostBytes, static_cast<std::uint8_t>(other));
          std::copy_n(whole.begin(), come, memory.begin());
          ASSERT_EQ(protocol->frame_length(std::span(memory).first(come)), 0) << come;
        }
      }
      ASSERT_EQ(protocol->frame_length(whole), static_cast<int>(whole.size()));
    }
  }
}

TEST_F(ServoFrames, AreNoneAtOnceWhereTheChecksumIsWrong) {
  const DynamixelProtocol dynamixel;
  const FeetechProtocol feetech;
  for (const ServoProtocol* protocol : {static_cast<const ServoProtocol*>(&dynamixel),
                                        static_cast<const ServoProtocol*>(&feetech)}) {
    std::array<std::uint8_t, ServoProtocol::kMostBytes> bytes;
    const std::size_t size = protocol->encode(ping_request(7), bytes);
    const auto frame = std::span(bytes).first(size);
    ASSERT_EQ(protocol->frame_length(frame), static_cast<int>(size));
    frame.back() ^= 0x10;
    EXPECT_EQ(protocol->frame_length(frame), -1);
  }
}

// Or a frame behind noise would have to wait for as long as the noise says.
TEST_F(ServoFrames, AreGivenUpAtTheFirstByteThatTells) {
  const DynamixelProtocol dynamixel;
  const FeetechProtocol feetech;
  const FrameBytes header{0xFF, 0xFF, 0xFD, 0x00};
  for (std::size_t k = 0; k < header.size(); ++k) {
    FrameBytes wrong(header.begin(), header.begin() + static_cast<std::ptrdiff_t>(k + 1));
    wrong.back() ^= 0x10;
    EXPECT_EQ(dynamixel.frame_length(wrong), -1) << k;
    if (k < 2) {
      EXPECT_EQ(feetech.frame_length(wrong), -1) << k;
    }
  }
  EXPECT_EQ(feetech.frame_length(FrameBytes{0xFF, 0xFF, 0xFF}), -1);
  const auto after_length = [&](const ServoProtocol& protocol, FrameBytes bytes, int length) {
    bytes.push_back(static_cast<std::uint8_t>(length & 0xFF));
    if (bytes.size() == 6) bytes.push_back(static_cast<std::uint8_t>(length >> 8));
    return protocol.frame_length(bytes);
  };
  for (const int length : {0, 1, 2, 234, 300, 0xFFFF}) {
    EXPECT_EQ(after_length(dynamixel, {0xFF, 0xFF, 0xFD, 0x00, 7}, length), -1) << length;
  }
  for (const int length : {3, 4, 233}) {
    EXPECT_EQ(after_length(dynamixel, {0xFF, 0xFF, 0xFD, 0x00, 7}, length), 0) << length;
  }
  for (const int length : {0, 1, 163, 255}) {
    EXPECT_EQ(after_length(feetech, {0xFF, 0xFF, 7}, length), -1) << length;
  }
  for (const int length : {2, 3, 162}) {
    EXPECT_EQ(after_length(feetech, {0xFF, 0xFF, 7}, length), 0) << length;
  }
}

// Not even where the checksum looks like what stuffs it.
TEST_F(ServoFrames, AHeaderAtTheEndOfABodyMustBeStuffed) {
  const DynamixelProtocol protocol;
  int looks_stuffed = 0;
  for (int k = 0; k < 4000; ++k) {
    FrameBytes body(4);
    std::generate(body.begin(), body.end(),
                  [this] { return static_cast<std::uint8_t>(random_()); });
    body.insert(body.end(), {0xFF, 0xFF, 0xFD});
    const FrameBytes bytes = dynamixel_frame(1, body);
    looks_stuffed += bytes[bytes.size() - 2] == 0xFD ? 1 : 0;
    ASSERT_EQ(protocol.frame_length(bytes), -1) << k;
  }
  EXPECT_GT(looks_stuffed, 0);
}

FrameBytes parameters_of(const ServoFrame& frame) {
  const auto used = frame.used();
  return {used.begin(), used.end()};
}

TEST(ServoRequests, SayAddressLengthAndBytesLowByteFirst) {
  const DynamixelProtocol wide;  // two bytes of address and length
  const FeetechProtocol narrow;  // one
  const ServoRegister at{.address = 0x0184, .size = 4};
  const ServoRegister near{.address = 0x2A, .size = 2};
  const std::array<std::uint8_t, 2> ids{1, 7};
  const std::array<std::uint32_t, 2> values{0x44332211U, 0x88776655U};
  const ServoFrame read = read_request(wide, 9, at);
  EXPECT_EQ(read.id, 9);
  EXPECT_EQ(read.code, 0x02);
  EXPECT_EQ(parameters_of(read), (FrameBytes{0x84, 0x01, 4, 0}));
  EXPECT_EQ(parameters_of(read_request(narrow, 9, near)), (FrameBytes{0x2A, 2}));
  const ServoFrame write = write_request(wide, 9, at, values[0]);
  EXPECT_EQ(write.id, 9);
  EXPECT_EQ(write.code, 0x03);
  EXPECT_EQ(parameters_of(write), (FrameBytes{0x84, 0x01, 0x11, 0x22, 0x33, 0x44}));
  EXPECT_EQ(parameters_of(write_request(narrow, 9, near, values[0])),
            (FrameBytes{0x2A, 0x11, 0x22}));
  const ServoFrame ask_all = sync_read_request(wide, at, ids);
  EXPECT_EQ(ask_all.id, 0xFE);
  EXPECT_EQ(ask_all.code, 0x82);
  EXPECT_EQ(parameters_of(ask_all), (FrameBytes{0x84, 0x01, 4, 0, 1, 7}));
  EXPECT_EQ(parameters_of(sync_read_request(narrow, near, ids)), (FrameBytes{0x2A, 2, 1, 7}));
  const ServoFrame tell_all = sync_write_request(narrow, near, ids, values);
  EXPECT_EQ(tell_all.id, 0xFE);
  EXPECT_EQ(tell_all.code, 0x83);
  EXPECT_EQ(parameters_of(tell_all), (FrameBytes{0x2A, 2, 1, 0x11, 0x22, 7, 0x55, 0x66}));
  EXPECT_EQ(parameters_of(sync_write_request(wide, at, ids, values)),
            (FrameBytes{0x84, 0x01, 4, 0, 1, 0x11, 0x22, 0x33, 0x44, 7, 0x55, 0x66, 0x77, 0x88}));
  EXPECT_EQ(ping_request(9).id, 9);
  EXPECT_EQ(ping_request(9).code, 0x01);
  EXPECT_EQ(ping_request(9).size, 0U);
}

bool same_register(ServoRegister at, int address, int size) {
  return at.address == address && at.size == size;
}

// "XL330-M288-T", control table.
TEST(ServoTables, OfDynamixelIsThatOfTheManual) {
  const ControlTable& table = DynamixelProtocol().table();
  EXPECT_EQ(table.address_bytes, 2);
  EXPECT_TRUE(same_register(table.torque, 64, 1));
  EXPECT_TRUE(same_register(table.errors, 70, 1));
  EXPECT_TRUE(same_register(table.watchdog, 98, 1));
  EXPECT_TRUE(same_register(table.goal, 116, 4));
  EXPECT_TRUE(same_register(table.present, 132, 4));
  EXPECT_TRUE(same_register(table.temperature, 146, 1));
  EXPECT_FALSE(table.errors_in_status);
  EXPECT_TRUE(same_register(table.torque_question, 64, 7)) << "to the errors";
  EXPECT_TRUE(same_register(table.watchdog_question, 98, 2));
  EXPECT_TRUE(same_register(table.temperature_question, 144, 3)) << "from the voltage";
}

// "STS3215 memory table".
TEST(ServoTables, OfFeetechIsThatOfTheManual) {
  const ControlTable& table = FeetechProtocol().table();
  EXPECT_EQ(table.address_bytes, 1);
  EXPECT_TRUE(same_register(table.torque, 40, 1));
  EXPECT_TRUE(same_register(table.goal, 42, 2));
  EXPECT_TRUE(same_register(table.present, 56, 2));
  EXPECT_TRUE(same_register(table.temperature, 63, 1));
  EXPECT_TRUE(same_register(table.errors, 65, 1));
  EXPECT_EQ(table.watchdog.size, 0) << "it has none";
  EXPECT_TRUE(table.errors_in_status);
  EXPECT_TRUE(same_register(table.torque_question, 40, 1));
  EXPECT_EQ(table.watchdog_question.size, 0);
  EXPECT_TRUE(same_register(table.temperature_question, 62, 3)) << "from the voltage";
}

TEST(ServoTables, WhatIsAskedHoldsWhatIsMeantAndNoTwoAnswersAreOfOneSize) {
  for (const auto& [protocol, frame] : families()) {
    const ControlTable& table = protocol->table();
    const auto holds = [](ServoRegister asked, ServoRegister meant) {
      return asked.address <= meant.address &&
             meant.address + meant.size <= asked.address + asked.size;
    };
    EXPECT_TRUE(holds(table.torque_question, table.torque));
    EXPECT_TRUE(table.errors_in_status || holds(table.torque_question, table.errors));
    EXPECT_TRUE(holds(table.watchdog_question, table.watchdog));
    EXPECT_TRUE(holds(table.temperature_question, table.temperature));
    std::vector<int> sizes;
    for (const ServoRegister at : {table.present, table.torque_question, table.watchdog_question,
                                   table.temperature_question}) {
      if (at.size != 0) sizes.push_back(at.size);
    }
    std::ranges::sort(sizes);
    EXPECT_EQ(std::ranges::adjacent_find(sizes), sizes.end());
  }
}

/// Each bit of the errors by itself; several say what each of them says.
void expect_complaints(const ServoProtocol& protocol, const std::array<int, 8>& of_bit) {
  for (unsigned errors = 0; errors < 256; ++errors) {
    int expected = 0;
    for (unsigned bit = 0; bit < 8; ++bit) {
      if (((errors >> bit) & 1U) != 0) expected |= of_bit[bit];
    }
    EXPECT_EQ(protocol.complaints(errors), expected) << errors;
  }
}

// "XL330-M288-T", hardware error status; "STS3215 memory table", servo status.
TEST(ServoTables, ComplaintsAreThoseOfTheBits) {
  expect_complaints(DynamixelProtocol(),
                    {kBadVoltage, 0, kTooHot, kDefect, kDefect, kOverload, 0, 0});
  expect_complaints(FeetechProtocol(),
                    {kBadVoltage, kDefect, kTooHot, kOverload, 0, kOverload, 0, 0});
}

TEST(ServoTables, PositionsOfFeetechAreASignAndASize) {
  const FeetechProtocol protocol;
  for (std::int32_t size = 0; size < 0x8000; ++size) {
    const auto bits = static_cast<std::uint32_t>(size);
    ASSERT_EQ(protocol.to_register(size), bits);
    ASSERT_EQ(protocol.to_position(bits), size);
    ASSERT_EQ(protocol.to_position(bits | 0x8000U), -size);
    if (size > 0) {
      ASSERT_EQ(protocol.to_register(-size), bits | 0x8000U);
    }
  }
}

}  // namespace
}  // namespace softfinger
