#include "softfinger/motors/weart/weart_bus.hpp"

#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "softfinger/motors/weart/weart_protocol.hpp"
#include "softfinger/wire/endpoint.hpp"

namespace softfinger {
namespace {

constexpr int kConnect_ms = 500;
/// A middleware that has not acknowledged anything for so long is gone.
constexpr unsigned kLongestSilence = 1000;  // ms
/// Bytes on their way: about three commands.
constexpr int kMostUnderWay = 128;

}  // namespace

WeartBus::WeartBus(const TransportSettings& transport) : point_(transport.servos.front()) {}

std::string WeartBus::open(const std::string& port) {
  close_socket();
  Endpoint endpoint;
  std::string reason = find_endpoint(port, endpoint);
  if (!reason.empty()) return reason;
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) return "the system has no more sockets";
  const int one = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  int error = 0;
  if (connect_socket(socket_, endpoint) != 0) {
    error = errno;
    if (error == EINPROGRESS) {
      pollfd event{.fd = socket_, .events = POLLOUT, .revents = 0};
      socklen_t size = sizeof error;
      if (::poll(&event, 1, kConnect_ms) != 1 ||
          ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size) != 0) {
        error = ETIMEDOUT;
      }
    }
  }
  if (error != 0) {
    close_socket();
    return error == ECONNREFUSED ? "nobody listens there; does the WEART middleware run?"
                                 : "it does not answer; does the WEART middleware run there?";
  }
  ::setsockopt(socket_, IPPROTO_TCP, TCP_USER_TIMEOUT, &kLongestSilence, sizeof kLongestSilence);
  if (!send_text(weart_start())) {
    close_socket();
    return "it hung up";
  }
  return {};
}

void WeartBus::close_socket() noexcept {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  waiting_from_ = 0;
  waiting_to_ = 0;
}

void WeartBus::close() noexcept {
  if (!is_open()) return;
  std::array<char, 64> text;
  const std::size_t size = encode_weart_stop_force(point_.address, text);
  if (send_text({text.data(), size})) send_text(weart_stop());
  close_socket();
}

bool WeartBus::flush() noexcept {
  while (waiting_from_ < waiting_to_) {
    const ssize_t put =
        ::send(socket_, waiting_.data() + waiting_from_, waiting_to_ - waiting_from_, MSG_NOSIGNAL);
    if (put > 0) {
      waiting_from_ += static_cast<std::size_t>(put);
    } else if (put < 0 && errno == EINTR) {
      continue;
    } else {
      if (put < 0 && errno != EAGAIN && errno != EWOULDBLOCK) close_socket();
      return false;
    }
  }
  return is_open();
}

bool WeartBus::send_text(std::string_view text) noexcept {
  if (!is_open() || !flush() || text.size() > waiting_.size()) return false;
  // What has not arrived yet would only be the past when it does.
  int under_way = 0;
  if (::ioctl(socket_, SIOCOUTQ, &under_way) == 0 && under_way > kMostUnderWay) return false;
  std::copy(text.begin(), text.end(), waiting_.begin());
  waiting_from_ = 0;
  waiting_to_ = text.size();
  flush();  // what the line does not take now goes first next time
  return is_open();
}

bool WeartBus::write(std::span<const std::int32_t> targets) noexcept {
  std::array<char, 128> text;
  const std::size_t size = targets[0] <= 0
                               ? encode_weart_stop_force(point_.address, text)
                               : encode_weart_force(targets[0] * point_.step, point_.address, text);
  return send_text({text.data(), size});
}

void WeartBus::drain() noexcept {
  std::array<char, 1024> told;
  // Bounded: a middleware that never stops talking must not hold up the commands.
  for (int i = 0; i < 64 && is_open(); ++i) {
    const ssize_t got = ::recv(socket_, told.data(), told.size(), 0);
    if (got > 0) continue;
    if (got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) close_socket();
    return;
  }
}

}  // namespace softfinger
