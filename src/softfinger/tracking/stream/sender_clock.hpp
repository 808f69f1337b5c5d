#pragma once

#include <limits>

namespace softfinger {

/// Maps the clock of a sender that only ever sends to ours. The datagram that was on its way for
/// the shortest time of the last 5 to 10 s sets the offset, so that how long others took beyond
/// that counts into the age of their poses. All times in s, ours on the monotonic clock.
class SenderClock {
 public:
  /// `window`: s, after so long, or twice that, an offset is forgotten; `longest_delay`: s.
  explicit SenderClock(double window = 5.0, double longest_delay = 1.0)
      : window_(window), longest_delay_(longest_delay) {}
  /// Our time of what was true at `sent` on the sender's clock and arrived at `received`; never
  /// later than `received`. Times that make no sense (over the longest delay: the sender set its
  /// clock) start anew.
  [[nodiscard]] double local_time(double sent, double received);
  void reset() { *this = SenderClock(window_, longest_delay_); }

 private:
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();
  double window_;
  double longest_delay_;
  double window_began_ = -kUnknown;
  double least_offset_ = kUnknown;    ///< of this window: received - sent
  double earlier_offset_ = kUnknown;  ///< of the window before
};

}  // namespace softfinger
