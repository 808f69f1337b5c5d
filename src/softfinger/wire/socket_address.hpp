#pragma once

#include "softfinger/wire/endpoint.hpp"

struct sockaddr;
struct sockaddr_in;

namespace softfinger {

/// An endpoint as the system's calls take it, and back.
[[nodiscard]] sockaddr_in to_system(const Endpoint& endpoint);
[[nodiscard]] Endpoint from_system(const sockaddr_in& address);

/// The socket interface takes every family of addresses by a pointer to its common beginning.
[[nodiscard]] const sockaddr* as_address(const sockaddr_in& address);
[[nodiscard]] sockaddr* as_address(sockaddr_in& address);

}  // namespace softfinger
