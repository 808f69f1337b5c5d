#include "softfinger/motors/osc/osc_bus.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include "softfinger/wire/socket_address.hpp"

namespace softfinger {

OscBus::OscBus(const TransportSettings& transport) : servos_(transport.servos) {
  for (const ServoSettings& servo : servos_) messages_.push_back({servo.address, 0.0F});
  bytes_.resize(osc_bundle_size(messages_));
}

std::string OscBus::open(const std::string& port) {
  close_socket();
  SocketAddress address;
  std::string reason = find_socket_address(port, address);
  if (!reason.empty()) return reason;
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ >= 0 && connect_socket(socket_, address) == 0) {
    return {};
  }
  close_socket();
  return "there is no way to it from here";
}

void OscBus::close_socket() noexcept {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

bool OscBus::write(std::span<const std::int32_t> targets) noexcept {
  for (std::size_t i = 0; i < messages_.size(); ++i) {
    messages_[i].value = static_cast<float>(targets[i] * servos_[i].step);
  }
  const std::size_t size = encode_osc_bundle(messages_, bytes_);
  // An error tells of an earlier datagram that nobody took; this one is sent by a second try.
  return ::send(socket_, bytes_.data(), size, MSG_NOSIGNAL) >= 0 ||
         ::send(socket_, bytes_.data(), size, MSG_NOSIGNAL) >= 0;
}

}  // namespace softfinger
