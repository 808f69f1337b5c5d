#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace softfinger {

/// IPv4 address and port, both in the processor's byte order.
struct UdpEndpoint {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  bool operator==(const UdpEndpoint&) const = default;
};

/// "127.0.0.1".
[[nodiscard]] std::string address_text(std::uint32_t address);
/// "127.0.0.1:1510".
[[nodiscard]] std::string text_of(const UdpEndpoint& endpoint);
/// The IPv4 address of a host: four numbers or a name to look up. Throws InputError.
[[nodiscard]] std::uint32_t find_address(const std::string& host);
/// The address of this machine from which datagrams to `address` would leave. Throws InputError
/// where there is no way to it.
[[nodiscard]] std::uint32_t local_address_towards(std::uint32_t address);

inline constexpr std::uint32_t kLoopback = 0x7f000001;  ///< 127.0.0.1
/// No UDP datagram over IPv4 is larger, bytes.
inline constexpr std::size_t kLargestDatagram = 65535;

/// A UDP socket over IPv4 that never blocks. Owns its descriptor; one thread at a time.
class UdpSocket {
 public:
  struct Datagram {
    std::size_t size = 0;  ///< bytes written to the buffer
    UdpEndpoint from;
  };

  /// Bound to `local`, its port 0: any free one. `shared`: others on this machine may be bound to
  /// the same multicast group and port. Throws InputError: port in use, no address of this machine.
  explicit UdpSocket(const UdpEndpoint& local, bool shared = false);
  ~UdpSocket();
  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&&) = delete;

  [[nodiscard]] const UdpEndpoint& local() const { return local_; }
  /// Receives what is sent to `group` by way of the interface with address `interface`, and from
  /// no other interface. Throws InputError.
  void join(std::uint32_t group, std::uint32_t interface);
  /// Sends multicast by way of this interface and no further than its network.
  void send_multicast_from(std::uint32_t interface);

  /// The next datagram that has arrived; none: nothing has, or it did not fit into `buffer`.
  [[nodiscard]] std::optional<Datagram> receive(std::span<std::uint8_t> buffer);
  /// As far as the system takes it: datagrams may be lost anyway.
  void send(const UdpEndpoint& to, std::span<const std::uint8_t> bytes);
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
  UdpEndpoint local_;
};

/// Waits until one of the sockets (descriptors, at most 4) has a datagram, or for `seconds`.
void wait_for_datagram(std::span<const int> descriptors, double seconds);

}  // namespace softfinger
