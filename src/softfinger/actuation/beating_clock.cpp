#include "softfinger/actuation/beating_clock.hpp"

#include <algorithm>

namespace softfinger {

BeatingClock::TimePoint BeatingClock::now() noexcept {
  const TimePoint now = clock_.now();
  beat_.store(std::chrono::duration<double>(now.time_since_epoch()).count(),
              std::memory_order_release);
  return now;
}

void BeatingClock::sleep_until(TimePoint due) noexcept {
  for (TimePoint at = now(); at < due; at = now()) {
    clock_.sleep_until(std::min<TimePoint>(due, at + kBeatEvery));
  }
}

bool BeatingClock::wait(std::span<pollfd> events, TimePoint due) noexcept {
  for (TimePoint at = now(); at < due; at = now()) {
    if (clock_.wait(events, std::min<TimePoint>(due, at + kBeatEvery))) return true;
  }
  return clock_.wait(events, due);
}

}  // namespace softfinger
