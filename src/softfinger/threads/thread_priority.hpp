#pragma once

namespace softfinger {

/// Threads of a loop paced by the wall clock; a later one yields to an earlier one.
enum class LoopThread { kTransport, kSimulation, kDevice };

/// The longest that a thread of real-time priority may go without sleep, s: far longer than a step
/// of the finest finger takes.
inline constexpr double kLongestRealTime = 5.0;

/// Lets the calling thread run when its time has come: sleeps end exactly, its stack is there from
/// now on, and it gets a real-time priority where the system grants one; without that it goes on as
/// any other. One that then never sleeps for kLongestRealTime, in a loop without end, ends the
/// process by SIGXCPU, so that it does not keep the machine from others; a shorter limit that the
/// process has (RLIMIT_RTTIME) stays.
void prefer_this_thread(LoopThread kind);

/// Sleeps a moment: for threads that are late and would not sleep by themselves.
void rest_a_moment();

/// Lets all other threads go before the calling one; they cannot be made to wait for it but by a
/// lock it holds.
void defer_this_thread();

}  // namespace softfinger
