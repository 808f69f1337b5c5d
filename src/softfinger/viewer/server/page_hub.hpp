#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/asio/ip/address.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/viewer/access_token.hpp"
#include "softfinger/viewer/page_file.hpp"
#include "softfinger/viewer/page_port.hpp"

namespace softfinger {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;

class ConnectionCount;
class PageStream;

/// What all connections of a server share; lives as long as the server, on its thread.
struct PageHub {
  /// What is asked for, with what has to stay until it is sent.
  struct Content {
    PageFile file;
    std::shared_ptr<const void> keeps = nullptr;
  };

  PageHub(const ServerOptions& options, bool encrypted);
  PageHub(const PageHub&) = delete;
  PageHub& operator=(const PageHub&) = delete;
  virtual ~PageHub() = default;

  /// Of a request's target; empty: there is none.
  [[nodiscard]] virtual std::optional<Content> find(std::string_view target) = 0;
  /// Whether /ws speaks WebSocket here.
  [[nodiscard]] virtual bool has_web_socket() const { return false; }
  /// Goes on with a connection that asked for it.
  virtual void take_web_socket(PageStream&& stream, ConnectionCount&& count,
                               const HttpRequest& request);

  AccessToken token;
  std::string address;
  std::string_view scheme;  ///< http or https
  std::uint16_t port = 0;
  VisitorCookie cookie = {};
  std::size_t connections = 0;
  std::vector<boost::asio::ip::address> unproven = {};  ///< who Unproven counts

  /// Where the page is, see Server::url().
  [[nodiscard]] std::string url() const;
  /// `local`: the address that the request came to.
  [[nodiscard]] bool is_foreign(const HttpRequest& request, std::string_view local) const;
  [[nodiscard]] bool is_admitted(const HttpRequest& request) const;
  /// Whether there is room for one more connection, from this address.
  [[nodiscard]] bool has_room_for(const boost::asio::ip::address& visitor) const;

  // What one visitor may take of the machine.
  static constexpr std::size_t kMaxConnections = 64;
  static constexpr std::size_t kMaxRequestBytes = 1024;
  static constexpr std::chrono::seconds kHttpTimeout{10};
  // And one that has not shown token or cookie, where there is a token; so that strangers keep
  // nobody out who has it. A browser has six connections at once.
  static constexpr std::size_t kMaxUnproven = 16;
  static constexpr std::size_t kMaxUnprovenOfOne = 8;  ///< from one address
  static constexpr std::chrono::seconds kProofTimeout{3};
};

/// Counts a connection while it lives.
class ConnectionCount {
 public:
  explicit ConnectionCount(PageHub& hub) : hub_(&hub) { ++hub_->connections; }
  ConnectionCount(ConnectionCount&& other) noexcept : hub_(std::exchange(other.hub_, nullptr)) {}
  ConnectionCount& operator=(ConnectionCount&&) = delete;
  ~ConnectionCount() {
    if (hub_ != nullptr) --hub_->connections;
  }

 private:
  PageHub* hub_;
};

/// Counts a connection while it has not shown the token or the cookie.
class Unproven {
 public:
  Unproven(PageHub& hub, boost::asio::ip::address visitor);
  Unproven(const Unproven&) = delete;
  Unproven& operator=(const Unproven&) = delete;
  ~Unproven();

 private:
  PageHub& hub_;
  boost::asio::ip::address visitor_;
};

}  // namespace softfinger
