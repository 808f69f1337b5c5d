// Readings of force sensors, as bytes.

#include "softfinger/sensing/force_message.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace softfinger {
namespace {

TEST(ForceLine, IsTheFirstNumberThatStandsByItself) {
  EXPECT_EQ(decode_force_line("0.52"), 0.52);
  EXPECT_EQ(decode_force_line("  -12345\t"), -12345.0);
  EXPECT_EQ(decode_force_line("+1e-3"), 1e-3);
  EXPECT_EQ(decode_force_line("HX711 reading: -0.52 N"), -0.52)
      << "a name with digits is no number";
  EXPECT_EQ(decode_force_line("F=3;T=21.5"), 3.0);
  for (const char* line : {"", "   ", "ready", "nan", "inf", "1e999", "0x10", "--3", "3N"}) {
    EXPECT_FALSE(decode_force_line(line)) << line;
  }
  EXPECT_FALSE(decode_force_line(std::string(kLongestForceLine, '0') + "1"));
}

TEST(ForceOsc, ReadsWhatItWrites) {
  const std::vector<std::uint8_t> packet = encode_force_osc(-0.25);
  EXPECT_EQ(decode_force_osc(packet), -0.25);
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_FALSE(decode_force_osc(std::span(packet).first(size))) << size;
  }
}

std::vector<std::string> lines_of(const std::vector<std::string>& pieces) {
  ForceLines lines;
  std::vector<std::string> found;
  for (const std::string& piece : pieces) {
    lines.feed({reinterpret_cast<const std::uint8_t*>(piece.data()), piece.size()},
               [&](std::string_view line) { found.emplace_back(line); });
  }
  return found;
}

TEST(ForceLines, AreTheSameHoweverTheBytesCome) {
  using Lines = std::vector<std::string>;
  const Lines expected{"1.5", "-2"};
  EXPECT_EQ(lines_of({"1.5\r\n-2\n3"}), expected) << "what has no end is no line yet";
  EXPECT_EQ(lines_of({"1", ".", "5\n", "-", "2\n", "3"}), expected);
  EXPECT_EQ(lines_of({std::string(5000, '7'), "\n1.5\n", "-2\n"}), expected)
      << "an endless line is passed over";
}

TEST(ForceLines, TheEndOfALineThatWasJoinedIsNone) {
  ForceLines lines;
  lines.begin_within_a_line();
  std::vector<std::string> found;
  const std::string bytes = "34\n56\n";  // of 1234
  lines.feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
             [&](std::string_view line) { found.emplace_back(line); });
  EXPECT_EQ(found, std::vector<std::string>{"56"});
}

}  // namespace
}  // namespace softfinger
