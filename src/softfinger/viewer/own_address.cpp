#include "softfinger/viewer/own_address.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <array>
#include <cstring>

namespace softfinger {

bool is_own_host(std::string_view host, std::string_view address, std::uint16_t port,
                 std::string_view scheme) {
  const std::uint16_t usual = scheme == "https" ? 443 : 80;
  for (const std::string_view name : {address, std::string_view("localhost")}) {
    if (host == fmt::format("{}:{}", name, port)) return true;
    if (port == usual && host == name) return true;  // browsers leave out the default port
  }
  return false;
}

bool is_own_origin(std::string_view origin, std::string_view address, std::uint16_t port,
                   std::string_view scheme) {
  const std::string start = fmt::format("{}://", scheme);
  return origin.starts_with(start) &&
         is_own_host(origin.substr(start.size()), address, port, scheme);
}

std::vector<std::string> addresses_of_this_machine() {
  std::vector<std::string> addresses{"127.0.0.1"};
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return addresses;
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    const bool reaches = (each->ifa_flags & IFF_UP) != 0 && (each->ifa_flags & IFF_LOOPBACK) == 0;
    if (!reaches || each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, each->ifa_addr, sizeof address);
    std::array<char, INET_ADDRSTRLEN> text{};
    if (::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size()) != nullptr) {
      addresses.insert(addresses.end() - 1, text.data());
    }
  }
  ::freeifaddrs(first);
  return addresses;
}

}  // namespace softfinger
