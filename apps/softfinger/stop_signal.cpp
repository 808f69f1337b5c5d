#include "stop_signal.hpp"

#include <signal.h>

namespace {

static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<bool> stop_asked{false};
softfinger::StopSignals signals;

void on_signal(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(signal, &action, nullptr);
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  const auto stop = [](int) { stop_asked.store(true); };
  on_signal(SIGINT, stop);
  on_signal(SIGTERM, stop);
  // A terminal that closes; who started the program by nohup wants it to go on.
  struct sigaction hang_up {};
  sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) on_signal(SIGHUP, stop);
  return stop_asked;
}

void outlive_quotas() { on_signal(SIGXFSZ, SIG_IGN); }

const softfinger::StopSignals& stop_devices_on_signals() {
  on_signal(SIGUSR1, [](int) { signals.stops.fetch_add(1); });
  on_signal(SIGUSR2, [](int) { signals.releases.fetch_add(1); });
  return signals;
}
