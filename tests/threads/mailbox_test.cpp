#include "softfinger/threads/mailbox.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

namespace softfinger {
namespace {

TEST(Mailbox, GivesTheNewestValueOnce) {
  Mailbox<int> box(7);
  EXPECT_EQ(box.latest(), 7);
  EXPECT_FALSE(box.refresh());
  for (const int value : {1, 2, 3}) {
    box.draft() = value;
    box.publish();
  }
  EXPECT_EQ(box.latest(), 7) << "nothing changes under the reader before it asks";
  EXPECT_TRUE(box.refresh());
  EXPECT_EQ(box.latest(), 3);
  EXPECT_FALSE(box.refresh());
}

TEST(Mailbox, ReaderNeverSeesATornOrAnOlderValue) {
  struct Value {
    std::array<std::uint64_t, 64> words{};
  };
  constexpr std::uint64_t kCount = 200'000;
  Mailbox<Value> box;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      box.draft().words.fill(i);
      box.publish();
    }
    done = true;
  });
  std::uint64_t last = 0, torn = 0, older = 0;
  while (true) {
    const bool end = done;
    if (box.refresh()) {
      const Value& value = box.latest();
      for (const std::uint64_t word : value.words) torn += word != value.words[0];
      older += value.words[0] <= last;
      last = value.words[0];
    } else if (end) {
      break;
    }
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(older, 0u);
  EXPECT_EQ(last, kCount) << "the last value arrives";
}

}  // namespace
}  // namespace softfinger
