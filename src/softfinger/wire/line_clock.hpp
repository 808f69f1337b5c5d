#pragma once

#include <chrono>
#include <span>

struct pollfd;  // <poll.h>

namespace softfinger {

/// The time in which a servo line and its bus live: the steady clock, which no setting of the wall
/// clock touches, or a simulated one where faults are to come at known moments.
class LineClock {
 public:
  using Duration = std::chrono::steady_clock::duration;
  using TimePoint = std::chrono::steady_clock::time_point;

  virtual ~LineClock() = default;
  [[nodiscard]] virtual TimePoint now() noexcept = 0;
  virtual void sleep_until(TimePoint due) noexcept = 0;
  void sleep_for(Duration duration) noexcept { sleep_until(now() + duration); }
  /// Until one of `events` happens, which is then marked there, or until `due`: false.
  virtual bool wait(std::span<pollfd> events, TimePoint due) noexcept = 0;
};

/// The steady clock; any number of threads may use it.
[[nodiscard]] LineClock& steady_line_clock() noexcept;

}  // namespace softfinger
