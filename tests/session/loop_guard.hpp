#pragma once

#include <cstdint>

namespace softfinger {

/// From now on, calls of the calling thread to malloc and its kin (operator new ends there) and to
/// pthread_mutex_lock are counted. The first of each prints where it came from.
void guard_this_thread();
struct GuardCounts {
  std::uint64_t allocations = 0;
  std::uint64_t locks = 0;
  std::uint64_t threads = 0;  ///< guarded so far
};
/// Counts of all guarded threads since the last reset.
[[nodiscard]] GuardCounts guard_counts();
void reset_guard();
/// Whether this build can count: sanitizers bring a malloc of their own.
[[nodiscard]] bool guard_works();

}  // namespace softfinger
