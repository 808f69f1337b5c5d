#include "softfinger/motors/servo_table/frame_reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "softfinger/motors/feetech/feetech_protocol.hpp"

namespace softfinger {
namespace {

using ReadBytes = std::vector<std::uint8_t>;

const ReadBytes kPing{0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB};

int frames_of(FrameReader& reader, const ReadBytes& bytes) {
  int frames = 0;
  reader.push(bytes, [&](const ServoFrame& frame) {
    EXPECT_EQ(frame.id, 1);
    EXPECT_EQ(frame.code, 1);
    ++frames;
  });
  return frames;
}

TEST(FrameReader, CountsFramesAndWhatIsNone) {
  const FeetechProtocol protocol;
  FrameReader reader(protocol);
  EXPECT_EQ(frames_of(reader, {0x12, 0xFF, 0x13}), 0);
  EXPECT_EQ(frames_of(reader, kPing), 1);
  EXPECT_EQ(frames_of(reader, kPing), 1);
  EXPECT_EQ(reader.bytes(), 15U);
  EXPECT_EQ(reader.frames(), 2U);
  EXPECT_EQ(reader.malformed_bytes(), 3U);
  for (std::size_t k = 0; k < kPing.size(); ++k) {
    EXPECT_EQ(frames_of(reader, {kPing[k]}), k + 1 == kPing.size() ? 1 : 0) << "byte by byte";
  }
  EXPECT_EQ(reader.frames(), 3U);
  EXPECT_EQ(reader.malformed_bytes(), 3U);
}

TEST(FrameReader, ForgetsTheHalfThatCameBeforeAReset) {
  const FeetechProtocol protocol;
  FrameReader reader(protocol);
  EXPECT_EQ(frames_of(reader, {0xFF, 0xFF, 0x01, 0x02}), 0);
  reader.reset();
  EXPECT_EQ(frames_of(reader, {0x01, 0xFB}), 0);
  EXPECT_EQ(frames_of(reader, kPing), 1);
}

/// Whatever begins may still become a frame of this one.
class EndlessProtocol : public FeetechProtocol {
 public:
  [[nodiscard]] int frame_length(std::span<const std::uint8_t>) const override { return 0; }
};

TEST(FrameReader, KeepsNoMoreThanTheLongestFrame) {
  const EndlessProtocol protocol;
  FrameReader reader(protocol);
  EXPECT_EQ(frames_of(reader, ReadBytes(1000, 0x07)), 0);
  EXPECT_EQ(reader.bytes(), 1000U);
  EXPECT_EQ(reader.malformed_bytes(), 1000U - (ServoProtocol::kMostBytes - 1));
}

}  // namespace
}  // namespace softfinger
