#include "softfinger/loop/step_pacer.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

/// How often the thread has slept.
long sleeps() {
  rusage usage{};
  EXPECT_EQ(::getrusage(RUSAGE_THREAD, &usage), 0);
  return usage.ru_nvcsw;
}

// By too little to be given up: a thread of real-time priority would have its processor for ever.
TEST(StepPacer, SleepsNowAndThenThoughItIsLate) {
  constexpr double kLatePeriod = 0.01;
  constexpr int kLateSteps = 40;
  StepPacer pacer(1.0 / kLatePeriod);
  const long before = sleeps();
  const double begin = monotonic_time();
  for (int step = 1; step <= kLateSteps; ++step) {
    while (monotonic_time() < begin + step * 1.05 * kLatePeriod) {
    }
    pacer.wait(step);
  }
  EXPECT_GE(pacer.misses(), kLateSteps - 1U);
  EXPECT_GE(sleeps() - before, 3);
}

}  // namespace
}  // namespace softfinger
