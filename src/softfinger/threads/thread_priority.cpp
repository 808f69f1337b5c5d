#include "softfinger/threads/thread_priority.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace softfinger {

void prefer_this_thread(LoopThread kind) {
  constexpr unsigned long kTimerSlack = 1000;  // ns
  prctl(PR_SET_TIMERSLACK, kTimerSlack, 0UL, 0UL, 0UL);
  sched_param parameters{};
  parameters.sched_priority = 12 - static_cast<int>(kind);
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
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
