#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/asio/ip/address.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/session/live_feed.hpp"
#include "softfinger/viewer/access_token.hpp"
#include "softfinger/viewer/page_file.hpp"

namespace softfinger {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;

/// What all connections of a server share; lives as long as the server, on its thread.
struct PageHub {
  using Bytes = std::shared_ptr<const std::vector<std::byte>>;
  using Text = std::shared_ptr<const std::string>;

  LiveFeed& feed;
  std::span<const PageFile> page;
  AccessToken token;
  std::string address;
  std::string_view scheme;  ///< http or https
  std::uint16_t port = 0;
  VisitorCookie cookie = {};
  std::size_t connections = 0;
  std::vector<boost::asio::ip::address> unproven = {};  ///< who Unproven counts
  /// The one page that moves fingers: the first that did, while it is there.
  const void* mover = nullptr;
  std::shared_ptr<const SceneDescription> description = nullptr;
  Text scene = nullptr;         ///< message of `description`
  Bytes snapshot = nullptr;     ///< newest one of that scene, may be null
  Text registration = nullptr;  ///< null until somebody asks for one
  Text fit = nullptr;           ///< the same
  std::string loading;          ///< LiveFeed::loading()

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
