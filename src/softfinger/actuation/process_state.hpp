#pragma once

namespace softfinger {

/// What the system says of a process (proc(5), /proc/PID/stat): running or ready to, asleep,
/// waiting for a device, stopped.
enum class ProcessState { kRunning, kAsleep, kInDriver, kStopped, kGone };

/// Allocates nothing.
[[nodiscard]] ProcessState process_state(int process) noexcept;
/// What all of its threads have used of processors, s; 0: it is gone.
[[nodiscard]] double process_cpu_time(int process) noexcept;

}  // namespace softfinger
