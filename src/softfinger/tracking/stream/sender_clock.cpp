#include "softfinger/tracking/stream/sender_clock.hpp"

#include <algorithm>

namespace softfinger {

double SenderClock::local_time(double sent, double received) {
  const double offset = received - sent;
  if (offset - std::min(least_offset_, earlier_offset_) > longest_delay_) reset();
  if (received - window_began_ > window_) {
    earlier_offset_ = least_offset_;
    least_offset_ = kUnknown;
    window_began_ = received;
  }
  least_offset_ = std::min(least_offset_, offset);
  return std::min(sent + std::min(least_offset_, earlier_offset_), received);
}

}  // namespace softfinger
