#include "softfinger/threads/thread_priority.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>

#include <cstddef>
#include <thread>

namespace softfinger {
namespace {

long page_faults() {
  rusage usage{};
  EXPECT_EQ(::getrusage(RUSAGE_THREAD, &usage), 0);
  return usage.ru_minflt;
}

[[gnu::noinline]] void use_much_stack() {
  unsigned char stack[std::size_t{200} << 10];
  volatile unsigned char* const bytes = stack;
  for (std::size_t i = 0; i < sizeof stack; i += 1024) bytes[i] = 1;
}

TEST(PreferredThread, HasItsStackThere) {
#ifdef SOFTFINGER_SANITIZED
  GTEST_SKIP() << "what a sanitizer notes of the stack comes as pages too";
#endif
  long before = 0;
  long after = 0;
  std::thread([&] {
    prefer_this_thread(LoopThread::kDevice);
    (void)page_faults();
    before = page_faults();
    use_much_stack();
    after = page_faults();
  }).join();
  EXPECT_LE(after - before, 5) << "of 50 pages";
}

bool is_granted() {
  bool granted = false;
  std::thread([&] {
    prefer_this_thread(LoopThread::kDevice);
    granted = ::sched_getscheduler(0) == SCHED_FIFO;
  }).join();
  return granted;
}

rlim_t real_time_limit() {
  rlimit limit{};
  EXPECT_EQ(::getrlimit(RLIMIT_RTTIME, &limit), 0);
  return limit.rlim_cur;
}

TEST(PreferredThread, MayNotGoWithoutSleepForEver) {
  (void)is_granted();
  EXPECT_LE(real_time_limit(), static_cast<rlim_t>(1e6 * kLongestRealTime));
}

/// With a shorter limit than ours, which stays.
[[noreturn]] void run_away() {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const rlimit short_limit{200'000, 60'000'000};
  ::setrlimit(RLIMIT_RTTIME, &short_limit);
  prefer_this_thread(LoopThread::kDevice);
  if (real_time_limit() != 200'000) ::raise(SIGABRT);
  for (volatile unsigned turns = 0;;) turns = turns + 1;
}

TEST(PreferredThreadDeathTest, ThatRunsAwayIsEnded) {
  if (!is_granted()) GTEST_SKIP() << "no real-time priority here";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(run_away(), testing::KilledBySignal(SIGXCPU), "");
}

}  // namespace
}  // namespace softfinger
