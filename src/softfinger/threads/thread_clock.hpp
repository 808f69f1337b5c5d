#pragma once

namespace softfinger {

/// CPU time used by the calling thread so far, s. Differences are meaningful, the origin is not.
[[nodiscard]] double thread_cpu_time();
/// Monotonic wall-clock time, s; the same origin for all threads of the machine.
[[nodiscard]] double monotonic_time();

}  // namespace softfinger
