#pragma once

#include <netinet/in.h>

#include <string>

namespace softfinger {

/// The IPv4 address of "HOST:PORT", HOST a name or four numbers, PORT 1 to 65535. Returns an empty
/// text, or in few words why there is none. A name may take time to look up.
[[nodiscard]] std::string find_socket_address(const std::string& host_and_port,
                                              sockaddr_in& address);

}  // namespace softfinger
