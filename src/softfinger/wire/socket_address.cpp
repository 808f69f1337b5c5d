#include "softfinger/wire/socket_address.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstdint>
#include <cstring>

namespace softfinger {

std::string find_socket_address(const std::string& host_and_port, SocketAddress& address) {
  const std::size_t colon = host_and_port.rfind(':');
  unsigned port = 0;
  const char* end = host_and_port.data() + host_and_port.size();
  const bool split = colon != std::string::npos && colon > 0;
  const auto [read, error] = split ? std::from_chars(host_and_port.data() + colon + 1, end, port)
                                   : std::from_chars_result{end, std::errc::invalid_argument};
  if (error != std::errc() || read != end || port < 1 || port > 65535) {
    return "it must be HOST:PORT, such as 127.0.0.1:9000";
  }
  addrinfo hints{};
  hints.ai_family = AF_INET;
  addrinfo* found = nullptr;
  const std::string host = host_and_port.substr(0, colon);
  if (::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0 || found == nullptr) {
    return "no machine of the name " + host + " is known";
  }
  sockaddr_in internet{};
  std::memcpy(&internet, found->ai_addr, sizeof internet);
  ::freeaddrinfo(found);
  address.host = internet.sin_addr.s_addr;
  address.port = htons(static_cast<std::uint16_t>(port));
  return {};
}

int connect_socket(int socket, const SocketAddress& address) {
  sockaddr_in internet{};
  internet.sin_family = AF_INET;
  internet.sin_addr.s_addr = address.host;
  internet.sin_port = address.port;
  return ::connect(socket, reinterpret_cast<const sockaddr*>(&internet), sizeof internet);
}

}  // namespace softfinger
