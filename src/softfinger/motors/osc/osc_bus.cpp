#include "softfinger/motors/osc/osc_bus.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include "softfinger/wire/endpoint.hpp"
#include "softfinger/wire/osc.hpp"

namespace softfinger {

OscBus::OscBus(const TransportSettings& transport) : servos_(transport.servos) {
  std::size_t size = kOscBundleStart;
  for (const ServoSettings& servo : servos_) {
    size += kOscElementStart + osc_message_size(servo.address, 1, OscNumber::kFloat32);
  }
  bytes_.resize(size);
}

std::string OscBus::open(const std::string& port) {
  close_socket();
  Endpoint endpoint;
  std::string reason = find_endpoint(port, endpoint);
  if (!reason.empty()) return reason;
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ >= 0 && connect_socket(socket_, endpoint) == 0) {
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
  OscWriter writer(bytes_);
  writer.bundle();
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    const double set_point = targets[i] * servos_[i].step;
    writer.message(servos_[i].address, {&set_point, 1}, OscNumber::kFloat32);
  }
  // An error tells of an earlier datagram that nobody took; this one is sent by a second try.
  return ::send(socket_, bytes_.data(), writer.size(), MSG_NOSIGNAL) >= 0 ||
         ::send(socket_, bytes_.data(), writer.size(), MSG_NOSIGNAL) >= 0;
}

}  // namespace softfinger
