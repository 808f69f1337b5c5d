#include "stop_signal.hpp"

#include <signal.h>

const std::atomic<bool>& stop_on_signals() {
  static std::atomic<bool> stop_asked{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked.store(true); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return stop_asked;
}
