#include "softfinger/threads/thread_priority.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>

namespace softfinger {
namespace {

/// Far more than a step, a tick or a command takes.
constexpr std::size_t kStack = std::size_t{256} << 10;
constexpr std::size_t kPage = 4096;

/// What is touched here for the first time is not later, in the middle of a step.
[[gnu::noinline]] void prefault_stack() {
  unsigned char stack[kStack];
  volatile unsigned char* const bytes = stack;
  for (std::size_t i = 0; i < kStack; i += kPage) bytes[i] = 0;
}

void bound_real_time() {
  rlimit limit{};
  const auto longest = static_cast<rlim_t>(1e6 * kLongestRealTime);
  if (getrlimit(RLIMIT_RTTIME, &limit) != 0 || limit.rlim_cur <= longest) return;
  limit.rlim_cur = longest;
  (void)setrlimit(RLIMIT_RTTIME, &limit);
}

}  // namespace

void prefer_this_thread(LoopThread kind) {
  constexpr unsigned long kTimerSlack = 1000;  // ns
  prctl(PR_SET_TIMERSLACK, kTimerSlack, 0UL, 0UL, 0UL);
  prefault_stack();
  bound_real_time();
  sched_param parameters{};
  parameters.sched_priority = 12 - static_cast<int>(kind);
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
}

void rest_a_moment() {
  constexpr timespec kMoment{.tv_sec = 0, .tv_nsec = 500'000};
  nanosleep(&kMoment, nullptr);
}

void defer_this_thread() {
  constexpr int kStep = 10;
  constexpr int kLast = 19;  // the least favoured the system knows
  // Of the thread alone: Linux takes its number for a process here.
  const auto thread = static_cast<id_t>(gettid());
  const int nice = std::min(kLast, getpriority(PRIO_PROCESS, thread) + kStep);
  (void)setpriority(PRIO_PROCESS, thread, nice);
}

}  // namespace softfinger
