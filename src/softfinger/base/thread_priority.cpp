#include "softfinger/base/thread_priority.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>

namespace softfinger {

void prefer_this_thread(LoopThread kind) {
  constexpr unsigned long kTimerSlack = 1000;  // ns
  prctl(PR_SET_TIMERSLACK, kTimerSlack, 0UL, 0UL, 0UL);
  sched_param parameters{};
  parameters.sched_priority = 12 - static_cast<int>(kind);
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
}

}  // namespace softfinger
