#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "softfinger/session/live_feed.hpp"
#include "softfinger/viewer/access_token.hpp"
#include "softfinger/viewer/certificate.hpp"
#include "softfinger/viewer/page_file.hpp"

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

/// Web server of the live page: HTTP on /, WebSocket on /ws, on a thread of its own. A client gets
/// the scene as JSON once per generation, then the newest snapshot at each update; where a client
/// is slow, older snapshots are dropped for it. What the page asks goes to LiveFeed::request.
/// Requests whose Host or Origin is not the address and port that they came to are refused (403).
/// Where there is a token, "/?token=TOKEN" answers with a cookie and everything else without that
/// cookie is refused (401); the cookie is this server's alone and ends with it.
class Server {
 public:
  /// Binds, then serves until destroyed. `feed` and `page` must outlive the server; the feed is
  /// only called from the server's thread. Throws InputError naming --port when the port is in use
  /// or not allowed, --listen when there is no such address or it needs a token or a certificate,
  /// --certificate or --key when they cannot be used.
  explicit Server(LiveFeed& feed, const ServerOptions& options = {},
                  std::span<const PageFile> page = live_page());
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// The port bound, never 0.
  [[nodiscard]] std::uint16_t port() const;
  /// Where the page is, e.g. "http://127.0.0.1:8080", with the token where one is needed. Served at
  /// all addresses: each of them, joined by " or ".
  [[nodiscard]] std::string url() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
