#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger {

/// Whether a Host header names this server: its own address or localhost, with its port, which may
/// be left out where it is the scheme's. Everything
/// else is foreign, so that no other site can reach the server through a visitor's browser (DNS
/// rebinding, cross-site requests).
[[nodiscard]] bool is_own_host(std::string_view host, std::string_view address, std::uint16_t port,
                               std::string_view scheme = "http");
/// The same for an Origin header: the scheme, "http" or "https", and an own host.
[[nodiscard]] bool is_own_origin(std::string_view origin, std::string_view address,
                                 std::uint16_t port, std::string_view scheme = "http");

/// IPv4 addresses that this machine has, those that others reach first and 127.0.0.1 last.
[[nodiscard]] std::vector<std::string> addresses_of_this_machine();

}  // namespace softfinger
