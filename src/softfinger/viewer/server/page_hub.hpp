#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

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
  std::size_t connections = 0;
  /// The one page that moves fingers: the first that did, while it is there.
  const void* mover = nullptr;
  std::shared_ptr<const SceneDescription> description = nullptr;
  Text scene = nullptr;         ///< message of `description`
  Bytes snapshot = nullptr;     ///< newest one of that scene, may be null
  Text registration = nullptr;  ///< null until somebody asks for one
  std::string loading;          ///< LiveFeed::loading()

  /// `local`: the address that the request came to.
  [[nodiscard]] bool is_foreign(const HttpRequest& request, std::string_view local) const;
  [[nodiscard]] bool is_admitted(const HttpRequest& request) const;

  // What one visitor may take of the machine.
  static constexpr std::size_t kMaxConnections = 64;
  static constexpr std::size_t kMaxRequestBytes = 1024;
  static constexpr std::chrono::seconds kHttpTimeout{10};
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

}  // namespace softfinger
