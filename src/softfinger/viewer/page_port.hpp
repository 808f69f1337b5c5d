#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "softfinger/viewer/access_token.hpp"
#include "softfinger/viewer/certificate.hpp"

namespace softfinger {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< IPv4 address to listen on; 0.0.0.0: on all
  std::uint16_t port = 8080;          ///< 0: any free port
  double update_rate = 60.0;          ///< snapshots a second, Hz
  /// What visitors must know; has to be there where the address is not this machine's loopback.
  AccessToken token = {};
  Certificate certificate = {};  ///< where given: HTTPS and WSS instead of HTTP and WS
  /// Not encrypted although other machines can come: whoever is on the network can read the token.
  bool plain_http = false;
};

/// The address and port of a page that is to be served, with its certificate: all of a Server that
/// can be refused, for what must not begin before. Who comes already waits until it is served.
class PagePort {
 public:
  /// Binds. Throws InputError naming --port when the port is in use or not allowed, --listen when
  /// there is no such address or it needs a token or a certificate, --certificate or --key when
  /// they cannot be used.
  explicit PagePort(ServerOptions options);
  ~PagePort();
  PagePort(PagePort&&) noexcept;
  PagePort& operator=(PagePort&&) = delete;

 private:
  friend class PageListener;
  friend class ReportServer;
  friend class Server;
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
