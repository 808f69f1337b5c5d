#include "softfinger/viewer/server/http_session.hpp"

#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include <fmt/core.h>

namespace softfinger {

namespace beast = boost::beast;
namespace http = beast::http;
using boost::asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::uint32_t kMaxHeaderBytes = 8 * 1024;
constexpr std::string_view kContentSecurityPolicy =
    "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; "
    "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

}  // namespace

HttpSession::HttpSession(PageStream&& stream, PageHub& hub, const boost::asio::ip::address& visitor)
    : hub_(hub),
      count_(hub),
      stream_(std::move(stream)),
      buffer_(kMaxHeaderBytes + PageHub::kMaxRequestBytes) {
  if (hub.token.is_needed()) unproven_.emplace(hub, visitor);
  error_code error;
  local_ = tcp_stream().socket().local_endpoint(error).address().to_string();
}

void HttpSession::set_deadline() {
  if (unproven_) {
    tcp_stream().expires_at(opened_ + PageHub::kProofTimeout);
  } else {
    tcp_stream().expires_after(PageHub::kHttpTimeout);
  }
}

void HttpSession::open() {
  set_deadline();
  stream_.open([self = shared_from_this()](error_code error) {
    if (!error) self->read();
  });
}

void HttpSession::read() {
  parser_.emplace();
  parser_->header_limit(kMaxHeaderBytes);
  set_deadline();
  http::async_read(
      stream_, buffer_, *parser_,
      [self = shared_from_this()](error_code error, std::size_t) { self->answer(error); });
}

void HttpSession::answer(error_code error) {
  if (error == http::error::header_limit) {
    return refuse(http::status::request_header_fields_too_large, "header too large\n");
  }
  if (error == http::error::unexpected_body || error == http::error::body_limit) {
    return refuse(http::status::payload_too_large, "no request of this page has a body\n");
  }
  if (error.category() == make_error_code(http::error::bad_method).category() &&
      error != http::error::end_of_stream && error != http::error::partial_message) {
    return refuse(http::status::bad_request, "not an HTTP request\n");
  }
  if (error) return;
  const HttpRequest& request = parser_->get();
  if (hub_.is_foreign(request, local_)) {
    return refuse(http::status::forbidden, "foreign Host or Origin\n");
  }
  const std::string_view target(request.target().data(), request.target().size());
  if (!hub_.is_admitted(request)) {
    if (hub_.token.is_in_target(target)) return admit();
    return refuse(http::status::unauthorized, "open /?token=TOKEN with the token of --token\n");
  }
  unproven_.reset();
  if (hub_.has_web_socket() && target.substr(0, target.find('?')) == "/ws") {
    return become_web_socket(request);
  }
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    return refuse(http::status::method_not_allowed, "only GET and HEAD\n");
  }
  const auto found = hub_.find(target);
  if (!found) return respond(http::status::not_found, "text/plain", "no such page\n");
  content_ = found->keeps;
  respond(http::status::ok, found->file.content_type, found->file.content);
}

void HttpSession::become_web_socket(const HttpRequest& request) {
  if (!beast::websocket::is_upgrade(request)) {
    return refuse(http::status::upgrade_required, "/ws speaks WebSocket\n");
  }
  hub_.take_web_socket(std::move(stream_), std::move(count_), request);
}

void HttpSession::admit() {
  unproven_.reset();
  const std::string cookie =
      fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}", VisitorCookie::name(hub_.port),
                  hub_.cookie.value(), hub_.scheme == "https" ? "; Secure" : "");
  respond(http::status::see_other, "text/plain", "", cookie);
}

void HttpSession::refuse(http::status status, std::string_view reason) {
  keep_alive_ = false;
  respond(status, "text/plain", reason);
}

void HttpSession::respond(http::status status, std::string_view content_type,
                          std::string_view content, std::string_view cookie) {
  const HttpRequest& request = parser_->get();
  const bool head = request.method() == http::verb::head;
  keep_alive_ = keep_alive_ && request.keep_alive();
  response_ = http::response<Body>(status, 11);
  const auto set = [this](http::field name, std::string_view value) {
    response_.set(name, beast::string_view(value.data(), value.size()));
  };
  set(http::field::content_type, content_type);
  set(http::field::cache_control, "no-cache");
  response_.set("Content-Security-Policy",
                beast::string_view(kContentSecurityPolicy.data(), kContentSecurityPolicy.size()));
  response_.set("X-Content-Type-Options", "nosniff");
  response_.set("Cross-Origin-Resource-Policy", "same-origin");
  if (status == http::status::method_not_allowed) set(http::field::allow, "GET, HEAD");
  if (!cookie.empty()) {
    set(http::field::set_cookie, cookie);
    set(http::field::location, "/");
  }
  response_.content_length(content.size());
  response_.keep_alive(keep_alive_);
  if (!head) response_.body() = beast::span<const char>(content.data(), content.size());
  serializer_.emplace(response_);
  serializer_->split(head);
  set_deadline();
  const auto sent = [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    if (self->keep_alive_) return self->read();
    error_code ignored;
    self->tcp_stream().socket().shutdown(tcp::socket::shutdown_send, ignored);
  };
  if (head) {
    http::async_write_header(stream_, *serializer_, sent);
  } else {
    http::async_write(stream_, *serializer_, sent);
  }
}

}  // namespace softfinger
