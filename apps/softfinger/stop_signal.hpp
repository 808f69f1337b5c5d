#pragma once

#include <atomic>

#include "softfinger/session/stop_signals.hpp"

/// From now on Ctrl-C, the terminate signal and a terminal that closes (unless that is ignored, as
/// by nohup) no longer end the program but set this flag. More than one does not hurry the end: a
/// device retracts, which takes about a second.
[[nodiscard]] const std::atomic<bool>& stop_on_signals();

/// From now on a quota that is full (`ulimit -f`) is an error of whoever writes, as a full disk is,
/// and no signal that ends the program.
void outlive_quotas();

/// From now on SIGUSR1 stops devices, for a pedal or a script, and SIGUSR2 asks to release them:
/// each counts.
[[nodiscard]] const softfinger::StopSignals& stop_devices_on_signals();
