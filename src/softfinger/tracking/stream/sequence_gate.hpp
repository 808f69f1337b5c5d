#pragma once

#include <cstdint>

#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// Lets through what a sender numbered later than all before; datagrams that were overtaken or
/// doubled on the way stay out. Numbers may wrap around (RFC 1982). A sender that starts anew with
/// lower numbers is heard once nothing has come through for kLostAfter, when tracking is lost
/// anyway.
class SequenceGate {
 public:
  /// `now`: s on the monotonic clock, never decreasing.
  [[nodiscard]] bool admits(std::uint32_t number, double now) {
    if (known_) {
      const bool newer = static_cast<std::int32_t>(number - newest_) > 0;
      restarted_ = !newer && number != newest_ && now - admitted_ > kLostAfter;
      if (!newer && !restarted_) return false;
    }
    known_ = true;
    newest_ = number;
    admitted_ = now;
    return true;
  }
  /// Whether what came through last was such a new start.
  [[nodiscard]] bool restarted() const { return restarted_; }

 private:
  bool known_ = false;
  bool restarted_ = false;
  std::uint32_t newest_ = 0;
  double admitted_ = 0.0;
};

}  // namespace softfinger
