#pragma once

#include <cstdint>
#include <string>

namespace softfinger {

/// IPv4, in the byte order of the network.
struct SocketAddress {
  std::uint32_t host = 0;
  std::uint16_t port = 0;
};

/// The address of "HOST:PORT", HOST a name or four numbers, PORT 1 to 65535. Returns an empty text,
/// or in few words why there is none. A name may take time to look up.
[[nodiscard]] std::string find_socket_address(const std::string& host_and_port,
                                              SocketAddress& address);

/// Connects a socket; as connect() does. UDP sockets have their peer then.
int connect_socket(int socket, const SocketAddress& address);

}  // namespace softfinger
