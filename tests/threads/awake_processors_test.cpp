#include "softfinger/threads/awake_processors.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>

namespace softfinger {
namespace {

TEST(AwakeProcessors, HoldsLinuxToNoLatencyWhereItMay) {
  constexpr auto kRequest = "/dev/cpu_dma_latency";
  const AwakeProcessors awake;
  if (::access(kRequest, W_OK) != 0) {
    EXPECT_FALSE(awake.granted());
    GTEST_SKIP() << kRequest << " is not there or not ours";
  }
  EXPECT_TRUE(awake.granted());
  std::ifstream request(kRequest, std::ios::binary);
  std::int32_t longest = -1;
  ASSERT_TRUE(request.read(reinterpret_cast<char*>(&longest), sizeof longest));
  EXPECT_EQ(longest, 0);
}

}  // namespace
}  // namespace softfinger
