#include "softfinger/wire/udp_socket.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/wire/socket_address.hpp"

namespace softfinger {
namespace {

Endpoint local_end(int descriptor) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  if (::getsockname(descriptor, as_address(address), &size) != 0) return {};
  return from_system(address);
}

template <typename Value>
bool set_option(int descriptor, int level, int name, const Value& value) {
  return ::setsockopt(descriptor, level, name, &value, sizeof value) == 0;
}

std::string reason_of(int error) { return std::system_category().message(error); }

}  // namespace

std::uint32_t local_address_towards(std::uint32_t address) {
  // Connecting a datagram socket sends nothing: it only looks for the way.
  const UdpSocket probe({});
  if (connect_socket(probe.descriptor(), {address, 9}) != 0) {
    throw InputError(fmt::format("no network of this machine leads to {}", address_text(address)));
  }
  return local_end(probe.descriptor()).address;
}

UdpSocket::UdpSocket(const Endpoint& local, bool shared)
    : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (descriptor_ < 0) {
    throw OperationError(fmt::format("the system gives no socket: {}", reason_of(errno)));
  }
  const sockaddr_in address = to_system(local);
  const bool set = !shared || set_option(descriptor_, SOL_SOCKET, SO_REUSEADDR, 1);
  if (!set || ::bind(descriptor_, as_address(address), sizeof address) != 0) {
    const int error = errno;
    ::close(descriptor_);
    if (error == EADDRINUSE) {
      throw InputError(
          fmt::format("port {} of {} is in use; end the other program or choose another port",
                      local.port, address_text(local.address)));
    }
    throw InputError(fmt::format("cannot receive at {}: {}", text_of(local), reason_of(error)));
  }
  local_ = local_end(descriptor_);
}

UdpSocket::~UdpSocket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), local_(other.local_) {}

void UdpSocket::join(std::uint32_t group, std::uint32_t interface) {
  ip_mreq request{};
  request.imr_multiaddr.s_addr = htonl(group);
  request.imr_interface.s_addr = htonl(interface);
  // Else groups that other programs joined elsewhere would be heard too.
  const bool only_here = set_option(descriptor_, IPPROTO_IP, IP_MULTICAST_ALL, 0);
  if (!only_here || !set_option(descriptor_, IPPROTO_IP, IP_ADD_MEMBERSHIP, request)) {
    throw InputError(fmt::format("cannot join multicast group {} on the interface of {}: {}",
                                 address_text(group), address_text(interface), reason_of(errno)));
  }
}

void UdpSocket::send_multicast_from(std::uint32_t interface) {
  const in_addr address{.s_addr = htonl(interface)};
  if (!set_option(descriptor_, IPPROTO_IP, IP_MULTICAST_IF, address)) {
    throw InputError(fmt::format("cannot send multicast from {}: {}", address_text(interface),
                                 reason_of(errno)));
  }
}

std::optional<UdpSocket::Datagram> UdpSocket::receive(std::span<std::uint8_t> buffer) {
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const ssize_t got =
      ::recvfrom(descriptor_, buffer.data(), buffer.size(), MSG_TRUNC, as_address(from), &size);
  if (got < 0 || static_cast<std::size_t>(got) > buffer.size()) return std::nullopt;
  return Datagram{static_cast<std::size_t>(got), from_system(from)};
}

void UdpSocket::send(const Endpoint& to, std::span<const std::uint8_t> bytes) {
  const sockaddr_in address = to_system(to);
  // The answer to an earlier datagram (port unreachable) may come back as this one's error.
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (::sendto(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL, as_address(address),
                 sizeof address) >= 0) {
      return;
    }
  }
}

void wait_for_datagram(std::span<const int> descriptors, double seconds) {
  std::array<pollfd, 4> sockets{};
  const std::size_t count = std::min(descriptors.size(), sockets.size());
  for (std::size_t i = 0; i < count; ++i) sockets[i] = {descriptors[i], POLLIN, 0};
  const int milliseconds = static_cast<int>(std::clamp(seconds, 0.0, 10.0) * 1e3);
  ::poll(sockets.data(), count, milliseconds);
}

}  // namespace softfinger
