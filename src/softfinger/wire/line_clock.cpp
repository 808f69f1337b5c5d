#include "softfinger/wire/line_clock.hpp"

#include <poll.h>

#include <algorithm>
#include <cstdint>
#include <thread>

namespace softfinger {
namespace {

class SteadyLineClock final : public LineClock {
 public:
  TimePoint now() noexcept override { return std::chrono::steady_clock::now(); }
  void sleep_until(TimePoint due) noexcept override { std::this_thread::sleep_until(due); }
  bool wait(std::span<pollfd> events, TimePoint due) noexcept override {
    const std::int64_t left = std::max<std::int64_t>(
        std::chrono::nanoseconds(due - std::chrono::steady_clock::now()).count(), 0);
    const timespec timeout{.tv_sec = left / 1'000'000'000, .tv_nsec = left % 1'000'000'000};
    return ::ppoll(events.data(), events.size(), &timeout, nullptr) > 0;
  }
};

}  // namespace

LineClock& steady_line_clock() noexcept {
  static SteadyLineClock clock;
  return clock;
}

}  // namespace softfinger
