#include "softfinger/viewer/own_address.hpp"

#include <fmt/core.h>

namespace softfinger {

bool is_own_host(std::string_view host, std::string_view address, std::uint16_t port) {
  for (const std::string_view name : {address, std::string_view("localhost")}) {
    if (host == fmt::format("{}:{}", name, port)) return true;
    if (port == 80 && host == name) return true;  // browsers leave out the default port
  }
  return false;
}

bool is_own_origin(std::string_view origin, std::string_view address, std::uint16_t port) {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && is_own_host(origin.substr(kScheme.size()), address, port);
}

}  // namespace softfinger
