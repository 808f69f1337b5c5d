#include "softfinger/wire/byte_order.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace softfinger {
namespace {

using testing::ElementsAre;

TEST(ByteOrder, LowBytesComeFirst) {
  ByteWriter writer;
  writer.u16(0x1234);
  writer.u32(0x89ABCDEF);
  writer.f32(1.0);
  writer.text("ab");
  EXPECT_THAT(writer.bytes(),
              ElementsAre(0x34, 0x12, 0xEF, 0xCD, 0xAB, 0x89, 0, 0, 0x80, 0x3F, 'a', 'b', 0));
}

TEST(ByteOrder, WhatIsWrittenIsReadBack) {
  std::mt19937_64 random(1);
  for (int k = 0; k < 1000; ++k) {
    const std::uint64_t number = random();
    const double real =
        std::ldexp(static_cast<double>(number), static_cast<int>(number % 200) - 100);
    ByteWriter writer;
    writer.u8(static_cast<std::uint8_t>(number));
    writer.u16(static_cast<std::uint16_t>(number));
    writer.u64(number);
    writer.i32(static_cast<std::int32_t>(number));
    writer.zeros(3);
    writer.f64(-real);
    writer.text("text");
    writer.append(std::array<std::uint8_t, 2>{7, 8});
    ByteReader reader(writer.bytes());
    EXPECT_EQ(reader.u8(), static_cast<std::uint8_t>(number));
    EXPECT_EQ(reader.u16(), static_cast<std::uint16_t>(number));
    EXPECT_EQ(reader.u64(), number);
    EXPECT_EQ(reader.i32(), static_cast<std::int32_t>(number));
    reader.skip(3);
    EXPECT_EQ(reader.f64(), -real);
    EXPECT_EQ(reader.text(), "text");
    EXPECT_EQ(reader.left(), 2u);
    EXPECT_THAT(reader.bytes(2), ElementsAre(7, 8));
    EXPECT_TRUE(reader.ok());
  }
}

TEST(ByteOrder, AfterTheEndAllIsZeroForGood) {
  const std::array<std::uint8_t, 5> bytes{1, 2, 3, 4, 5};
  ByteReader reader(bytes);
  EXPECT_EQ(reader.u32(), 0x04030201u);
  EXPECT_EQ(reader.u16(), 0u) << "one byte is none of two";
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.u8(), 0u) << "what was left is gone with it";
  EXPECT_EQ(reader.left(), 0u);
  ByteReader endless(bytes);
  EXPECT_EQ(endless.text(), "") << "no NUL";
  EXPECT_FALSE(endless.ok());
}

TEST(ByteOrder, CountsThatCannotBeAreNone) {
  for (const std::uint32_t count : {0u, 2u, 3u, std::numeric_limits<std::uint32_t>::max()}) {
    ByteWriter writer;
    writer.u32(count);
    writer.zeros(17);
    ByteReader reader(writer.bytes());
    EXPECT_EQ(reader.count_of(8), count <= 2 ? count : 0u);
    EXPECT_EQ(reader.ok(), count <= 2);
  }
}

}  // namespace
}  // namespace softfinger
