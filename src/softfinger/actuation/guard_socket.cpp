#include "softfinger/actuation/guard_socket.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdint>

namespace softfinger::guard_socket {
namespace {

bool send_bytes(int socket, const char* bytes, std::size_t size) noexcept {
  while (size > 0) {
    const ssize_t sent = ::send(socket, bytes, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_bytes(int socket, char* bytes, std::size_t size,
                   std::chrono::steady_clock::time_point until) {
  while (size > 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        until - std::chrono::steady_clock::now());
    pollfd event{.fd = socket, .events = POLLIN, .revents = 0};
    if (left.count() <= 0) return false;
    if (::poll(&event, 1, static_cast<int>(left.count())) <= 0) continue;
    const ssize_t got = ::recv(socket, bytes, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace

bool send(int socket, const std::string& text) noexcept {
  const auto size = static_cast<std::uint32_t>(text.size());
  return text.size() <= kLongest &&
         send_bytes(socket, reinterpret_cast<const char*>(&size), sizeof size) &&
         send_bytes(socket, text.data(), text.size());
}

bool receive(int socket, std::string& text, std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  std::uint32_t size = 0;
  if (!receive_bytes(socket, reinterpret_cast<char*>(&size), sizeof size, until)) return false;
  if (size > kLongest) return false;
  text.resize(size);
  return receive_bytes(socket, text.data(), size, until);
}

}  // namespace softfinger::guard_socket
