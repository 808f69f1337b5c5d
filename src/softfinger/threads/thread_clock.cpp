#include "softfinger/threads/thread_clock.hpp"

#include <time.h>

namespace softfinger {
namespace {

double read_clock(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double thread_cpu_time() { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

double monotonic_time() { return read_clock(CLOCK_MONOTONIC); }

}  // namespace softfinger
