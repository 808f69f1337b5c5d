#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace softfinger {

/// Maps a NatNet server's ticks to our monotonic clock. Of the last echoes the one with the
/// shortest round trip counts: the server read its clock in the middle of it, up to half the
/// difference between the two ways. Our times in s.
class NatNetClock {
 public:
  /// Forgets all echoes; the server's clock runs at this rate, above 0.
  void reset(std::uint64_t ticks_per_second);
  /// An echo asked for at `sent` and answered at `received`, with the server's ticks in between.
  /// Round trips over 1 s are not looked at; a server whose clock jumped is believed.
  void add(double sent, double received, std::uint64_t ticks);
  /// Our time at `ticks`; none before the first echo.
  [[nodiscard]] std::optional<double> local_time(std::uint64_t ticks) const;

 private:
  struct Echo {
    double middle = 0.0;
    double round_trip = 0.0;
    std::uint64_t ticks = 0;
  };
  [[nodiscard]] double local_time(const Echo& echo, std::uint64_t ticks) const;

  // At two echoes a second 8 s: 0.4 ms of drift at 50 parts in a million.
  std::array<Echo, 16> echoes_{};
  std::size_t count_ = 0;  ///< ever added
  std::size_t best_ = 0;
  double seconds_per_tick_ = 1.0;
};

}  // namespace softfinger
