#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/span_body.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "softfinger/viewer/server/page_hub.hpp"
#include "softfinger/viewer/server/page_stream.hpp"

namespace softfinger {

/// One connection until it ends or becomes a WebSocket, which the hub then has.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(PageStream&& stream, PageHub& hub, const boost::asio::ip::address& visitor);
  void open();

 private:
  using Body = boost::beast::http::span_body<const char>;

  boost::beast::tcp_stream& tcp_stream() { return stream_.next_layer(); }
  /// Until when what comes next has to be done.
  void set_deadline();
  void read();
  void answer(boost::system::error_code error);
  void become_web_socket(const HttpRequest& request);
  /// Hands over the cookie, and sends the visitor to where the address bar shows no token.
  void admit();
  void refuse(boost::beast::http::status status, std::string_view reason);
  void respond(boost::beast::http::status status, std::string_view content_type,
               std::string_view content, std::string_view cookie = {});

  PageHub& hub_;
  ConnectionCount count_;
  std::optional<Unproven> unproven_;  ///< empty: its visitor has shown that they may come
  std::chrono::steady_clock::time_point opened_ = std::chrono::steady_clock::now();
  PageStream stream_;
  std::string local_;  ///< address that the visitor came to
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> parser_;
  std::shared_ptr<const void> content_;  ///< what the response's body points into
  boost::beast::http::response<Body> response_;
  std::optional<boost::beast::http::response_serializer<Body>> serializer_;
  bool keep_alive_ = true;
};

}  // namespace softfinger
