#include "softfinger/motors/emulation/emulator_socket.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

/// How long the thread sleeps when nothing comes: two servo steps.
constexpr int kPatience_ms = 2;

}  // namespace

EmulatorSocket::EmulatorSocket(BusEmulator& emulator, Kind kind)
    : emulator_(emulator), datagrams_(kind == Kind::kUdp) {
  const int type = datagrams_ ? SOCK_DGRAM : SOCK_STREAM;
  socket_ = ::socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* at = reinterpret_cast<sockaddr*>(&address);
  if (socket_ < 0 || ::bind(socket_, at, size) != 0 || (!datagrams_ && ::listen(socket_, 1) != 0) ||
      ::getsockname(socket_, at, &size) != 0) {
    const int error = errno;
    if (socket_ >= 0) ::close(socket_);
    throw OperationError(fmt::format("no socket on loopback for the emulator: {}",
                                     std::system_category().message(error)));
  }
  port_ = fmt::format("127.0.0.1:{}", ntohs(address.sin_port));
  thread_ = std::thread([this] { serve(); });
}

EmulatorSocket::~EmulatorSocket() { vanish(); }

void EmulatorSocket::vanish() {
  if (!thread_.joinable()) return;
  stop_ = true;
  thread_.join();
  ::close(socket_);
  if (client_ >= 0) ::close(client_);
}

bool EmulatorSocket::take_bytes(int from) {
  std::array<std::uint8_t, 2048> buffer;
  const ssize_t got = ::recv(from, buffer.data(), buffer.size(), 0);
  if (got < 0) return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
  if (got == 0 && !datagrams_) return false;
  emulator_.receive(std::span(buffer).first(static_cast<std::size_t>(got)));
  if (datagrams_) return true;
  const std::size_t answer = emulator_.take_replies(buffer);
  // Who does not read loses answers.
  if (answer > 0) ::send(from, buffer.data(), answer, MSG_NOSIGNAL);
  return true;
}

void EmulatorSocket::serve() {
  const auto start = std::chrono::steady_clock::now();
  while (!stop_.load(std::memory_order_relaxed)) {
    const bool talks = datagrams_ || client_ >= 0;
    pollfd line{.fd = client_ >= 0 ? client_ : socket_, .events = POLLIN, .revents = 0};
    ::poll(&line, 1, kPatience_ms);
    emulator_.advance_to(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if (line.revents == 0) continue;
    if (!talks) {
      client_ = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    } else if (!take_bytes(line.fd) && client_ >= 0) {
      ::close(client_);
      client_ = -1;
    }
  }
}

}  // namespace softfinger
