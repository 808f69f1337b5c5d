#include "softfinger/tracking/stream/sequence_gate.hpp"

#include <gtest/gtest.h>

namespace softfinger {
namespace {

TEST(SequenceGate, LetsThroughOnlyWhatIsNewer) {
  SequenceGate gate;
  EXPECT_TRUE(gate.admits(7, 0.0)) << "the first may have any number";
  EXPECT_FALSE(gate.admits(7, 0.01)) << "doubled";
  EXPECT_TRUE(gate.admits(9, 0.01)) << "one was lost";
  EXPECT_FALSE(gate.admits(8, 0.01)) << "overtaken";
  EXPECT_TRUE(gate.admits(10, 0.02));
  EXPECT_FALSE(gate.restarted());
}

TEST(SequenceGate, NumbersMayWrapAround) {
  SequenceGate gate;
  for (std::uint32_t k = 0; k < 8; ++k) EXPECT_TRUE(gate.admits(0xFFFFFFFCu + k, 0.01 * k)) << k;
  EXPECT_FALSE(gate.admits(0xFFFFFFFFu, 0.1));
}

TEST(SequenceGate, ASenderThatStartsAnewIsHeardOnceTrackingIsLost) {
  SequenceGate gate;
  ASSERT_TRUE(gate.admits(1000, 0.0));
  EXPECT_FALSE(gate.admits(1, 0.9 * kLostAfter));
  EXPECT_FALSE(gate.admits(1000, 2.0 * kLostAfter)) << "the same again is no new start";
  EXPECT_TRUE(gate.admits(2, 1.1 * kLostAfter));
  EXPECT_TRUE(gate.restarted());
  EXPECT_TRUE(gate.admits(3, 1.2 * kLostAfter));
  EXPECT_FALSE(gate.restarted());
}

}  // namespace
}  // namespace softfinger
