#pragma once

#include <atomic>
#include <cstdint>

namespace softfinger {

/// Stops and releases that came from outside of a run, as signals do: counts, so that a handler can
/// add to them.
struct StopSignals {
  std::atomic<std::uint32_t> stops{0};
  std::atomic<std::uint32_t> releases{0};
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

}  // namespace softfinger
