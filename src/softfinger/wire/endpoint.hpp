#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace softfinger {

/// IPv4 address and port, both in the processor's byte order.
struct Endpoint {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  bool operator==(const Endpoint&) const = default;
};

inline constexpr std::uint32_t kLoopback = 0x7f000001;  ///< 127.0.0.1

/// "127.0.0.1".
[[nodiscard]] std::string address_text(std::uint32_t address);
/// "127.0.0.1:1510".
[[nodiscard]] std::string text_of(const Endpoint& endpoint);
/// The IPv4 address of a host, four numbers or a name; none: nobody knows it. A name may take time
/// to look up.
[[nodiscard]] std::optional<std::uint32_t> look_up(const std::string& host);
/// The same; throws InputError where nobody knows it.
[[nodiscard]] std::uint32_t find_address(const std::string& host);
/// The endpoint of "HOST:PORT", PORT 1 to 65535. Returns an empty text, or in few words why there
/// is none.
[[nodiscard]] std::string find_endpoint(const std::string& host_and_port, Endpoint& endpoint);

/// Connects a socket; as connect() does. UDP sockets have their peer then.
int connect_socket(int socket, const Endpoint& endpoint);

}  // namespace softfinger
