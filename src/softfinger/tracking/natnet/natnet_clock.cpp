#include "softfinger/tracking/natnet/natnet_clock.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

constexpr double kLongestRoundTrip = 1.0;  // s
constexpr double kClockJump = 1.0;         // s

}  // namespace

void NatNetClock::reset(std::uint64_t ticks_per_second) {
  count_ = 0;
  seconds_per_tick_ = 1.0 / static_cast<double>(ticks_per_second);
}

void NatNetClock::add(double sent, double received, std::uint64_t ticks) {
  const double round_trip = received - sent;
  if (!(round_trip >= 0.0 && round_trip <= kLongestRoundTrip)) return;
  const Echo echo{0.5 * (sent + received), round_trip, ticks};
  if (const auto expected = local_time(ticks);
      expected && std::abs(*expected - echo.middle) > kClockJump) {
    count_ = 0;
  }
  echoes_[count_++ % echoes_.size()] = echo;
  const auto end = echoes_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, echoes_.size()));
  best_ = static_cast<std::size_t>(
      std::min_element(echoes_.begin(), end,
                       [](const Echo& a, const Echo& b) { return a.round_trip < b.round_trip; }) -
      echoes_.begin());
}

double NatNetClock::local_time(const Echo& echo, std::uint64_t ticks) const {
  // The difference first: ticks since a server's start may need more digits than a double has.
  const auto since = static_cast<std::int64_t>(ticks - echo.ticks);
  return echo.middle + static_cast<double>(since) * seconds_per_tick_;
}

std::optional<double> NatNetClock::local_time(std::uint64_t ticks) const {
  if (count_ == 0) return std::nullopt;
  return local_time(echoes_[best_], ticks);
}

}  // namespace softfinger
