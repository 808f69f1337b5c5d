#include "softfinger/viewer/own_address.hpp"

#include <fmt/core.h>

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

}  // namespace softfinger
