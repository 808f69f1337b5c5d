#include "softfinger/threads/ring_buffer.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>
#include <vector>

namespace softfinger {
namespace {

TEST(RingBuffer, GivesBackInOrderAndSaysFullAndEmpty) {
  RingBuffer<int> ring(3);
  EXPECT_EQ(ring.front(), nullptr);
  for (int i = 0; i < 3; ++i) {
    ASSERT_NE(ring.claim(), nullptr);
    *ring.claim() = i;
    ring.publish();
  }
  EXPECT_EQ(ring.claim(), nullptr);
  for (int i = 0; i < 3; ++i) {
    ASSERT_NE(ring.front(), nullptr);
    EXPECT_EQ(*ring.front(), i);
    ring.release();
  }
  EXPECT_EQ(ring.front(), nullptr);
}

TEST(RingBuffer, ElementsKeepTheirStorage) {
  RingBuffer<std::vector<int>> ring(2, std::vector<int>(100));
  const int* storage = ring.claim()->data();
  const std::vector<int> other(100, 7);
  for (int round = 0; round < 3; ++round) {  // three slots in all
    *ring.claim() = other;
    ring.publish();
    ASSERT_EQ(ring.front()->at(99), 7);
    ring.release();
  }
  EXPECT_EQ(ring.claim()->data(), storage);
}

TEST(RingBuffer, TwoThreadsLoseAndTearNothing) {
  struct Element {
    std::uint64_t value = 0, inverse = ~std::uint64_t{0};
  };
  constexpr std::uint64_t kCount = 200'000;
  RingBuffer<Element> ring(64);
  std::thread producer([&] {
    for (std::uint64_t i = 0; i < kCount;) {
      if (Element* slot = ring.claim()) {
        *slot = {i, ~i};
        ring.publish();
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t i = 0; i < kCount;) {
    if (const Element* element = ring.front()) {
      wrong += element->value != i || element->inverse != ~i;
      ring.release();
      ++i;
    } else {
      std::this_thread::yield();
    }
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace softfinger
