#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "softfinger/session/live_feed.hpp"
#include "softfinger/viewer/page_file.hpp"
#include "softfinger/viewer/page_port.hpp"

namespace softfinger {

/// Web server of the live page: HTTP on /, WebSocket on /ws, on a thread of its own. A client gets
/// the scene as JSON once per generation, then the newest snapshot at each update; where a client
/// is slow, older snapshots are dropped for it. What the page asks goes to LiveFeed::request.
/// Requests whose Host or Origin is not the address and port that they came to are refused (403).
/// Where there is a token, "/?token=TOKEN" answers with a cookie and everything else without that
/// cookie is refused (401); the cookie is this server's alone and ends with it.
class Server {
 public:
  /// Binds, as PagePort does, then serves until destroyed. `feed` and `page` must outlive the
  /// server; the feed is only called from the server's thread. Throws InputError.
  explicit Server(LiveFeed& feed, const ServerOptions& options = {},
                  std::span<const PageFile> page = live_page());
  /// The same at a port that is bound already.
  Server(LiveFeed& feed, PagePort port, std::span<const PageFile> page = live_page());
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
