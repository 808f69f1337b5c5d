#pragma once

namespace softfinger {

/// What the system says of a process (proc(5), /proc/PID/stat): running or ready to, asleep,
/// waiting for a device, stopped.
enum class ProcessState { kRunning, kAsleep, kInDriver, kStopped, kGone };

/// Allocates nothing.
[[nodiscard]] ProcessState process_state(int process) noexcept;

}  // namespace softfinger
