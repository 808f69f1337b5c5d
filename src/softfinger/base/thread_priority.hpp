#pragma once

namespace softfinger {

/// Threads of a loop paced by the wall clock; a later one yields to an earlier one.
enum class LoopThread { kTransport, kSimulation, kDevice };

/// Lets the calling thread run when its time has come: sleeps end exactly, and it gets a real-time
/// priority where the system grants one; without that it goes on as any other.
void prefer_this_thread(LoopThread kind);

}  // namespace softfinger
