#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/recording/record.hpp"

namespace softfinger {

/// Sends each event of a run to another program at once, for a vibration motor or a sound: an OSC
/// message /softfinger/event of kind, object and other (texts; other empty: none), time_s and
/// impulse_N_s (float32; NaN: none).
class EventSender {
 public:
  /// `to`: "osc:HOST:PORT". `names` of objects, then of fingers, as events number them. Throws
  /// InputError where it is none, or there is no way to it.
  EventSender(std::string_view to, std::vector<std::string> names);
  ~EventSender();
  EventSender(const EventSender&) = delete;
  EventSender& operator=(const EventSender&) = delete;

  /// One datagram, which is lost where nobody takes it. Never waits, allocates nothing.
  void send(const EventRecord& event) noexcept;

 private:
  std::vector<std::string> names_;
  std::vector<std::uint8_t> bytes_;
  int socket_ = -1;
};

}  // namespace softfinger
