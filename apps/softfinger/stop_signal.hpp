#pragma once

#include <atomic>

/// From now on Ctrl-C, the terminate signal and a terminal that closes (unless that is ignored, as
/// by nohup) no longer end the program but set this flag. More than one does not hurry the end: a
/// device retracts, which takes about a second.
[[nodiscard]] const std::atomic<bool>& stop_on_signals();

/// From now on a quota that is full (`ulimit -f`) is an error of whoever writes, as a full disk is,
/// and no signal that ends the program.
void outlive_quotas();

/// From now on SIGUSR1 sets this flag: the emergency stop, for a pedal or a script.
[[nodiscard]] const std::atomic<bool>& emergency_stop_on_signal();
