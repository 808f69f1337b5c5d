#include "softfinger/threads/thread_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace softfinger {
namespace {

TEST(ThreadClock, SleepingTakesWallTimeButNoCpuTime) {
  const double cpu = thread_cpu_time();
  const double wall = monotonic_time();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GE(monotonic_time() - wall, 0.049);
  EXPECT_LT(thread_cpu_time() - cpu, 0.02);
}

TEST(ThreadClock, WorkTakesCpuTime) {
  const double start = thread_cpu_time();
  const double deadline = monotonic_time() + 10.0;
  while (thread_cpu_time() - start < 0.005 && monotonic_time() < deadline) {
  }
  EXPECT_GE(thread_cpu_time() - start, 0.005);
}

}  // namespace
}  // namespace softfinger
