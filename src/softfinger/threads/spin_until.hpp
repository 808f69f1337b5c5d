#pragma once

#include <thread>

namespace softfinger {

/// Tells the processor that this thread is looking for what another one writes.
inline void pause_while_looking() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Waits for what another thread is about to finish. Takes no lock; now and then it lets another
/// thread of the same priority have the processor, which may be the one waited for.
template <typename Done>
void spin_until(const Done& done) {
  constexpr int kLooksATurn = 1000;
  for (int looks = 1; !done(); ++looks) {
    pause_while_looking();
    if (looks % kLooksATurn == 0) std::this_thread::yield();
  }
}

}  // namespace softfinger
