#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>

#include <variant>

namespace softfinger {

/// A connection, plain or over TLS: what Beast asks of an asynchronous stream.
class PageStream {
 public:
  using executor_type = boost::beast::tcp_stream::executor_type;

  PageStream(boost::asio::ip::tcp::socket&& socket, boost::asio::ssl::context* tls)
      : stream_(tls == nullptr ? Stream(std::in_place_type<Plain>, std::move(socket))
                               : Stream(std::in_place_type<Secure>, std::move(socket), *tls)) {}

  boost::beast::tcp_stream& next_layer() {
    auto* secure = std::get_if<Secure>(&stream_);
    return secure != nullptr ? secure->next_layer() : std::get<Plain>(stream_);
  }
  executor_type get_executor() { return next_layer().get_executor(); }

  /// Calls done(error) once bytes may be exchanged.
  template <typename Done>
  void open(Done&& done) {
    if (auto* secure = std::get_if<Secure>(&stream_)) {
      secure->async_handshake(boost::asio::ssl::stream_base::server, std::forward<Done>(done));
    } else {
      done(boost::system::error_code());
    }
  }
  template <typename Buffers, typename Handler>
  auto async_read_some(const Buffers& buffers, Handler&& handler) {
    if (auto* secure = std::get_if<Secure>(&stream_)) {
      return secure->async_read_some(buffers, std::forward<Handler>(handler));
    }
    return std::get<Plain>(stream_).async_read_some(buffers, std::forward<Handler>(handler));
  }
  template <typename Buffers, typename Handler>
  auto async_write_some(const Buffers& buffers, Handler&& handler) {
    if (auto* secure = std::get_if<Secure>(&stream_)) {
      return secure->async_write_some(buffers, std::forward<Handler>(handler));
    }
    return std::get<Plain>(stream_).async_write_some(buffers, std::forward<Handler>(handler));
  }

 private:
  using Plain = boost::beast::tcp_stream;
  using Secure = boost::beast::ssl_stream<boost::beast::tcp_stream>;
  using Stream = std::variant<Plain, Secure>;
  Stream stream_;
};

/// Ends the connection after the closing messages of a WebSocket, which say all that TLS would.
template <typename Handler>
void async_teardown(boost::beast::role_type role, PageStream& stream, Handler&& handler) {
  boost::beast::websocket::async_teardown(role, stream.next_layer().socket(),
                                          std::forward<Handler>(handler));
}

}  // namespace softfinger
