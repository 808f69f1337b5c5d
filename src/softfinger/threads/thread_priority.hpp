#pragma once

namespace softfinger {

/// Threads of a loop paced by the wall clock; a later one yields to an earlier one.
enum class LoopThread { kTransport, kSimulation, kDevice };

/// Lets the calling thread run when its time has come: sleeps end exactly, and it gets a real-time
/// priority where the system grants one; without that it goes on as any other.
void prefer_this_thread(LoopThread kind);

/// Lets all other threads go before the calling one; they cannot be made to wait for it but by a
/// lock it holds.
void defer_this_thread();

}  // namespace softfinger
