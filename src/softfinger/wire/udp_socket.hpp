#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "softfinger/wire/endpoint.hpp"

namespace softfinger {

/// The address of this machine from which datagrams to `address` would leave. Throws InputError
/// where there is no way to it.
[[nodiscard]] std::uint32_t local_address_towards(std::uint32_t address);

/// No UDP datagram over IPv4 is larger, bytes.
inline constexpr std::size_t kLargestDatagram = 65535;

/// A UDP socket over IPv4 that never blocks. Owns its descriptor; one thread at a time.
class UdpSocket {
 public:
  struct Datagram {
    std::size_t size = 0;  ///< bytes written to the buffer
    Endpoint from;
  };

  /// Bound to `local`, its port 0: any free one. `shared`: others on this machine may be bound to
  /// the same multicast group and port. Throws InputError: port in use, no address of this machine.
  explicit UdpSocket(const Endpoint& local, bool shared = false);
  ~UdpSocket();
  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&&) = delete;

  [[nodiscard]] const Endpoint& local() const { return local_; }
  /// Receives what is sent to `group` by way of the interface with address `interface`, and from
  /// no other interface. Throws InputError.
  void join(std::uint32_t group, std::uint32_t interface);
  /// Sends multicast by way of this interface and no further than its network.
  void send_multicast_from(std::uint32_t interface);

  /// The next datagram that has arrived; none: nothing has, or it did not fit into `buffer`.
  [[nodiscard]] std::optional<Datagram> receive(std::span<std::uint8_t> buffer);
  /// As far as the system takes it: datagrams may be lost anyway.
  void send(const Endpoint& to, std::span<const std::uint8_t> bytes);
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
  Endpoint local_;
};

/// Waits until one of the sockets (descriptors, at most 4) has a datagram, or for `seconds`.
void wait_for_datagram(std::span<const int> descriptors, double seconds);

}  // namespace softfinger
