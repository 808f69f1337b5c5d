#pragma once

#include <limits>

namespace softfinger {

/// Maps the clock of a sender that only ever sends to ours. The datagram that was on its way for
/// the shortest time of the last 5 to 10 s sets the offset, so that how long others took beyond
/// that counts into the age of their poses. All times in s, ours on the monotonic clock.
class SenderClock {
 public:
  /// Our time of what was true at `sent` on the sender's clock and arrived at `received`; never
  /// later than `received`. Times that make no sense (over 1 s of delay: the sender set its clock)
  /// start anew.
  [[nodiscard]] double local_time(double sent, double received);
  void reset() { *this = SenderClock(); }

 private:
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();
  double window_began_ = -kUnknown;
  double least_offset_ = kUnknown;    ///< of this window: received - sent
  double earlier_offset_ = kUnknown;  ///< of the window before
};

}  // namespace softfinger
