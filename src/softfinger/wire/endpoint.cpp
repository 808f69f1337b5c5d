#include "softfinger/wire/endpoint.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstring>

#include "softfinger/base/error.hpp"
#include "softfinger/wire/socket_address.hpp"

namespace softfinger {

std::string address_text(std::uint32_t address) {
  return fmt::format("{}.{}.{}.{}", address >> 24, (address >> 16) & 0xff, (address >> 8) & 0xff,
                     address & 0xff);
}

std::string text_of(const Endpoint& endpoint) {
  return fmt::format("{}:{}", address_text(endpoint.address), endpoint.port);
}

std::optional<std::uint32_t> look_up(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0 || found == nullptr) {
    return std::nullopt;
  }
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  ::freeaddrinfo(found);
  return from_system(address).address;
}

std::uint32_t find_address(const std::string& host) {
  if (const auto address = look_up(host)) return *address;
  throw InputError(
      fmt::format("no host '{}': expected an IPv4 address or a name known to this machine", host));
}

std::string find_endpoint(const std::string& host_and_port, Endpoint& endpoint) {
  const std::size_t colon = host_and_port.rfind(':');
  unsigned port = 0;
  const char* end = host_and_port.data() + host_and_port.size();
  const bool split = colon != std::string::npos && colon > 0;
  const auto [read, error] = split ? std::from_chars(host_and_port.data() + colon + 1, end, port)
                                   : std::from_chars_result{end, std::errc::invalid_argument};
  if (error != std::errc() || read != end || port < 1 || port > 65535) {
    return "it must be HOST:PORT, such as 127.0.0.1:9000";
  }
  const std::string host = host_and_port.substr(0, colon);
  const auto address = look_up(host);
  if (!address) return "no machine of the name " + host + " is known";
  endpoint = {*address, static_cast<std::uint16_t>(port)};
  return {};
}

int connect_socket(int socket, const Endpoint& endpoint) {
  const sockaddr_in address = to_system(endpoint);
  return ::connect(socket, as_address(address), sizeof address);
}

}  // namespace softfinger
