#pragma once

#include <chrono>
#include <string>

/// Between a process and the guard of its device's port.
namespace softfinger::guard_socket {

// Descriptors of the guard process.
inline constexpr int kSocket = 3;  ///< to the parent; at its end the parent is gone
inline constexpr int kMemory = 4;  ///< the LineChannel
inline constexpr int kWake = 5;    ///< event descriptor: something was submitted
inline constexpr int kFirstForeign = 6;

/// A text of at most kLongest bytes, its length before it. False: the other side is gone.
bool send(int socket, const std::string& text) noexcept;
/// False: the other side is gone, silent for so long, or says what no peer of ours does.
bool receive(int socket, std::string& text, std::chrono::milliseconds patience);
inline constexpr std::uint32_t kLongest = 1U << 26U;

}  // namespace softfinger::guard_socket
