#include "softfinger/loop/step_pacer.hpp"

#include <time.h>

#include <cerrno>
#include <cmath>

#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/threads/thread_priority.hpp"

namespace softfinger {
namespace {

/// Further behind than this (s) the run does not catch up, it continues from now: a suspended
/// machine must not replay its sleep at full speed.
constexpr double kCatchUp = 0.1;
/// The longest without sleep, s.
constexpr double kLongestAwake = 0.1;

}  // namespace

StepPacer::StepPacer(double rate) : period_(1.0 / rate), slept_(monotonic_time()) { restart(1); }

void StepPacer::restart(std::int64_t step) {
  first_ = step;
  origin_ = monotonic_time();
}

void StepPacer::wait(std::int64_t step) {
  const double deadline = origin_ + static_cast<double>(step - first_ + 1) * period_;
  const double now = monotonic_time();
  if (now > deadline) {
    ++misses_;
    if (now > deadline + kCatchUp) {
      // A scene too heavy for this machine must leave it some time.
      const timespec rest{.tv_sec = 0, .tv_nsec = static_cast<long>(0.1 * kCatchUp * 1e9)};
      nanosleep(&rest, nullptr);
      restart(step + 1);
      slept_ = now;
    } else if (now > slept_ + kLongestAwake) {
      rest_a_moment();
      slept_ = now;
    }
    return;
  }
  slept_ = deadline;
  timespec until{};
  double seconds = 0.0;
  until.tv_nsec = static_cast<long>(std::modf(deadline, &seconds) * 1e9);
  until.tv_sec = static_cast<time_t>(seconds);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace softfinger
