#include "softfinger/export/mcap/mcap_writer.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "../support/temporary_directory.hpp"
#include "softfinger/export/mcap/cdr_writer.hpp"

namespace softfinger {
namespace {

using ByteList = std::vector<std::uint8_t>;

ByteList bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

TEST(Crc32, HasTheCheckValueOfItsCatalogue) {
  EXPECT_EQ(crc32_of(bytes_of("123456789")), 0xCBF43926U);
  Crc32 in_parts;
  in_parts.add(bytes_of("1234"));
  in_parts.add(bytes_of("56789"));
  EXPECT_EQ(in_parts.value(), 0xCBF43926U);
}

TEST(CdrWriter, AlignsNumbersToTheirSizeBehindTheEncoding) {
  CdrWriter cdr;
  cdr.u8(7);
  cdr.f64(1.0);
  cdr.text("ab");
  cdr.u8(9);
  cdr.i32(-2);
  const auto bytes = cdr.bytes();
  const ByteList expected{0,    1,    0,    0,                          // little-endian CDR
                          7,    0,    0,    0,   0,   0,   0,    0,     // a byte, then to 8
                          0,    0,    0,    0,   0,   0,   0xF0, 0x3F,  // 1.0
                          3,    0,    0,    0,   'a', 'b', 0,           // with its NUL
                          9,                                            // at 23, so that 24 is next
                          0xFE, 0xFF, 0xFF, 0xFF};
  EXPECT_EQ(ByteList(bytes.begin(), bytes.end()), expected);
}

class McapWriting : public testing::Test {
 protected:
  /// A file with so many messages of so many bytes.
  std::string file_of(int messages, std::size_t size) {
    const std::string name = directory_ / "run.mcap";
    FileBeside beside(name);
    McapWriter mcap(beside, "test");
    const std::uint16_t channel =
        mcap.add_channel("/topic", "std_msgs/msg/String", "string data\n");
    const ByteList message(size, 0x5A);
    for (int i = 0; i < messages; ++i) mcap.write(channel, static_cast<std::uint64_t>(i), message);
    mcap.close();
    EXPECT_TRUE(mcap.ok());
    EXPECT_TRUE(beside.take_its_place());
    std::ifstream stream(name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  TemporaryDirectory directory_;
};

TEST_F(McapWriting, AFileBeginsAndEndsWithItsMark) {
  const std::string mark("\x89MCAP0\r\n", 8);
  for (const int messages : {0, 1}) {
    const std::string file = file_of(messages, 100);
    EXPECT_TRUE(file.starts_with(mark)) << messages;
    EXPECT_TRUE(file.ends_with(mark)) << messages;
  }
}

TEST_F(McapWriting, ChunksAreOfAboutAMegabyte) {
  const std::size_t size = 100'000;
  const std::string small = file_of(10, size);
  const std::string large = file_of(40, size);
  // A chunk costs some hundred bytes more than what is in it.
  EXPECT_GT(large.size(), 40 * size);
  EXPECT_LT(large.size(), 40 * size + 6000);
  EXPECT_LT(small.size(), 10 * size + 2000);
}

}  // namespace
}  // namespace softfinger
