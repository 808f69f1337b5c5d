#pragma once

#include <atomic>

#include "softfinger/wire/line_clock.hpp"

namespace softfinger {

/// A line's clock that shows, whenever it is asked for the time or slept by, that the line is
/// alive, and lets nobody sleep for longer than kBeatEvery without that.
class BeatingClock final : public LineClock {
 public:
  /// Both outlive this. `beat`: s on the monotonic clock.
  BeatingClock(LineClock& clock, std::atomic<double>& beat) : clock_(clock), beat_(beat) {}

  static constexpr std::chrono::milliseconds kBeatEvery{20};

  [[nodiscard]] TimePoint now() noexcept override;
  void sleep_until(TimePoint due) noexcept override;
  bool wait(std::span<pollfd> events, TimePoint due) noexcept override;

 private:
  LineClock& clock_;
  std::atomic<double>& beat_;
};

}  // namespace softfinger
