#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/viewer/hand_message.hpp"
#include "softfinger/viewer/own_address.hpp"
#include "softfinger/viewer/page_request.hpp"
#include "softfinger/viewer/registration_message.hpp"
#include "softfinger/viewer/scene_message.hpp"
#include "softfinger/viewer/server.hpp"
#include "softfinger/viewer/snapshot_message.hpp"

namespace softfinger {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

// What one visitor may take of the machine.
constexpr std::size_t kMaxConnections = 64;
constexpr std::uint32_t kMaxHeaderBytes = 8 * 1024;
constexpr std::size_t kMaxRequestBytes = 1024;
constexpr int kSendBufferBytes = 64 * 1024;  // small: what waits in it is no longer the newest
constexpr auto kHttpTimeout = std::chrono::seconds(10);
constexpr auto kIdleTimeout = std::chrono::minutes(5);
constexpr auto kRequestInterval = std::chrono::milliseconds(20);
constexpr auto kHandInterval = std::chrono::milliseconds(3);  // two hands at 144 Hz

constexpr std::string_view kContentSecurityPolicy =
    "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; "
    "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

using Bytes = std::shared_ptr<const std::vector<std::byte>>;
using Text = std::shared_ptr<const std::string>;
using HttpRequest = http::request<http::empty_body>;

std::string_view value_of(const HttpRequest& request, http::field name) {
  return {request[name].data(), request[name].size()};
}

/// What all connections share; lives as long as the server.
struct Hub {
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

  /// `local`: the address that the request came to.
  bool is_foreign(const HttpRequest& request, std::string_view local) const {
    const auto hosts = request.count(http::field::host);
    const auto origins = request.count(http::field::origin);
    return hosts != 1 || !is_own_host(value_of(request, http::field::host), local, port, scheme) ||
           origins > 1 ||
           (origins == 1 &&
            !is_own_origin(value_of(request, http::field::origin), local, port, scheme));
  }
  bool is_admitted(const HttpRequest& request) const {
    return !token.is_needed() || token.is_in_cookies(value_of(request, http::field::cookie));
  }
};

/// Counts a connection while it lives.
class ConnectionCount {
 public:
  explicit ConnectionCount(Hub& hub) : hub_(&hub) { ++hub_->connections; }
  ConnectionCount(ConnectionCount&& other) noexcept : hub_(std::exchange(other.hub_, nullptr)) {}
  ConnectionCount& operator=(ConnectionCount&&) = delete;
  ~ConnectionCount() {
    if (hub_ != nullptr) --hub_->connections;
  }

 private:
  Hub* hub_;
};

/// A connection, plain or over TLS: what Beast asks of an asynchronous stream.
class PageStream {
 public:
  using executor_type = beast::tcp_stream::executor_type;

  PageStream(tcp::socket&& socket, asio::ssl::context* tls)
      : stream_(tls == nullptr ? Stream(std::in_place_type<Plain>, std::move(socket))
                               : Stream(std::in_place_type<Secure>, std::move(socket), *tls)) {}

  beast::tcp_stream& next_layer() {
    auto* secure = std::get_if<Secure>(&stream_);
    return secure != nullptr ? secure->next_layer() : std::get<Plain>(stream_);
  }
  executor_type get_executor() { return next_layer().get_executor(); }

  /// Calls done(error) once bytes may be exchanged.
  template <typename Done>
  void open(Done&& done) {
    if (auto* secure = std::get_if<Secure>(&stream_)) {
      secure->async_handshake(asio::ssl::stream_base::server, std::forward<Done>(done));
    } else {
      done(error_code());
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
  using Plain = beast::tcp_stream;
  using Secure = beast::ssl_stream<beast::tcp_stream>;
  using Stream = std::variant<Plain, Secure>;
  Stream stream_;
};

/// Ends the connection after the closing messages of a WebSocket, which say all that TLS would.
template <typename Handler>
void async_teardown(beast::role_type role, PageStream& stream, Handler&& handler) {
  websocket::async_teardown(role, stream.next_layer().socket(), std::forward<Handler>(handler));
}

/// One page that watches. Holds at most one message being sent, and the newest ones to send next.
class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(PageStream&& stream, Hub& hub, ConnectionCount&& count)
      : hub_(hub),
        count_(std::move(count)),
        socket_(std::move(stream)),
        pause_(socket_.get_executor()) {}

  ~WebSocketSession() {
    if (hub_.mover == this) hub_.mover = nullptr;
  }
  WebSocketSession(const WebSocketSession&) = delete;
  WebSocketSession& operator=(const WebSocketSession&) = delete;

  void accept(const HttpRequest& request) {
    beast::get_lowest_layer(socket_).expires_never();
    socket_.set_option(websocket::stream_base::timeout{kHttpTimeout, kIdleTimeout, true});
    socket_.read_message_max(kMaxRequestBytes);
    socket_.auto_fragment(false);  // one message, one frame: easy to read for other clients
    socket_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->open_ = true;
      self->offer_scene();
      self->offer_registration();
      self->offer_snapshot();
      self->read();
    });
  }
  void offer_scene() {
    next_scene_ = hub_.scene;
    next_snapshot_ = nullptr;  // of the scene before
    write();
  }
  void offer_registration() {
    next_registration_ = hub_.registration;
    write();
  }
  void offer_snapshot() {
    next_snapshot_ = hub_.snapshot;
    write();
  }

 private:
  void write() {
    if (writing_ || !open_) return;
    if (next_scene_) {
      scene_in_flight_ = std::exchange(next_scene_, nullptr);
      socket_.text(true);
      send(asio::buffer(*scene_in_flight_));
    } else if (next_registration_) {
      registration_in_flight_ = std::exchange(next_registration_, nullptr);
      socket_.text(true);
      send(asio::buffer(*registration_in_flight_));
    } else if (next_snapshot_) {
      snapshot_in_flight_ = std::exchange(next_snapshot_, nullptr);
      socket_.binary(true);
      send(asio::buffer(*snapshot_in_flight_));
    }
  }
  void send(asio::const_buffer message) {
    writing_ = true;
    socket_.async_write(message, [self = shared_from_this()](error_code error, std::size_t) {
      self->writing_ = false;
      self->open_ = self->open_ && !error;
      self->write();
    });
  }
  void read() {
    buffer_.clear();
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) {
        self->open_ = false;
        return;
      }
      self->obey();
    });
  }
  void obey() {
    const auto data = buffer_.cdata();
    const std::string_view message(static_cast<const char*>(data.data()), data.size());
    if (socket_.got_text() ? obey_request(message) : obey_hand(message)) {
      pause_.expires_after(socket_.got_text() ? kRequestInterval : kHandInterval);
      return read_after_pause();
    }
    open_ = false;
    socket_.async_close({websocket::close_code::policy_error, "not a request of the live page"},
                        [self = shared_from_this()](error_code) {});
  }
  bool obey_request(std::string_view message) {
    const auto& scene = hub_.description;
    const auto request = parse_page_request(
        message, scene ? std::span(scene->scene_names) : std::span<const std::string>());
    if (!request) return false;
    if (request->kind != LiveRequest::Kind::kPose || is_mover()) hub_.feed.request(*request);
    return true;
  }
  bool obey_hand(std::string_view message) {
    const auto hand = parse_hand_message(message);
    if (hand && is_mover()) hub_.feed.offer_hand(*hand);
    return hand.has_value();
  }
  /// Whether this page moves the fingers, now that it wants to.
  bool is_mover() {
    if (hub_.mover == nullptr) hub_.mover = this;
    return hub_.mover == this;
  }
  void read_after_pause() {
    pause_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->read();
    });
  }

  Hub& hub_;
  ConnectionCount count_;
  websocket::stream<PageStream> socket_;
  asio::steady_timer pause_;
  beast::flat_buffer buffer_{kMaxRequestBytes};
  Text next_scene_, scene_in_flight_;
  Text next_registration_, registration_in_flight_;
  Bytes next_snapshot_, snapshot_in_flight_;
  bool open_ = false;
  bool writing_ = false;
};

using Watchers = std::vector<std::weak_ptr<WebSocketSession>>;

/// One connection until it ends or becomes a WebSocket.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(PageStream&& stream, Hub& hub, Watchers& watchers)
      : hub_(hub), count_(hub), stream_(std::move(stream)), watchers_(watchers) {
    error_code error;
    local_ = tcp_stream().socket().local_endpoint(error).address().to_string();
  }

  void open() {
    tcp_stream().expires_after(kHttpTimeout);
    stream_.open([self = shared_from_this()](error_code error) {
      if (!error) self->read();
    });
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeaderBytes);
    tcp_stream().expires_after(kHttpTimeout);
    http::async_read(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](error_code error, std::size_t) { self->answer(error); });
  }

 private:
  using Response = http::response<http::span_body<const char>>;

  beast::tcp_stream& tcp_stream() { return stream_.next_layer(); }

  void answer(error_code error) {
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
    if (target.substr(0, target.find('?')) == "/ws") {
      if (!websocket::is_upgrade(request)) {
        return refuse(http::status::upgrade_required, "/ws speaks WebSocket\n");
      }
      auto session =
          std::make_shared<WebSocketSession>(std::move(stream_), hub_, std::move(count_));
      std::erase_if(watchers_, [](const auto& watcher) { return watcher.expired(); });
      watchers_.push_back(session);
      session->accept(request);
      return;
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return refuse(http::status::method_not_allowed, "only GET and HEAD\n");
    }
    const PageFile* file = find_page_file(hub_.page, target);
    if (file == nullptr) return respond(http::status::not_found, "text/plain", "no such page\n");
    respond(http::status::ok, file->content_type, file->content);
  }
  /// Hands over the cookie, and sends the visitor to where the address bar shows no token.
  void admit() {
    const std::string cookie =
        fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}", AccessToken::kCookie,
                    hub_.token.text(), hub_.scheme == "https" ? "; Secure" : "");
    respond(http::status::see_other, "text/plain", "", cookie);
  }
  void refuse(http::status status, std::string_view reason) {
    keep_alive_ = false;
    respond(status, "text/plain", reason);
  }
  void respond(http::status status, std::string_view content_type, std::string_view content,
               std::string_view cookie = {}) {
    const HttpRequest& request = parser_->get();
    const bool head = request.method() == http::verb::head;
    keep_alive_ = keep_alive_ && request.keep_alive();
    response_ = Response(status, 11);
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
    tcp_stream().expires_after(kHttpTimeout);
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

  Hub& hub_;
  ConnectionCount count_;
  PageStream stream_;
  Watchers& watchers_;
  std::string local_;  ///< address that the visitor came to
  beast::flat_buffer buffer_{kMaxHeaderBytes + kMaxRequestBytes};
  std::optional<http::request_parser<http::empty_body>> parser_;
  Response response_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
  bool keep_alive_ = true;
};

}  // namespace

struct Server::Implementation {
  Implementation(LiveFeed& feed, const ServerOptions& options, std::span<const PageFile> page)
      : hub{feed,
            page,
            options.token,
            options.address,
            options.certificate.is_given() ? "https" : "http",
            options.port},
        tls(options.certificate.is_given()
                ? std::make_unique<asio::ssl::context>(tls_context(options.certificate).release())
                : nullptr),
        period(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
            std::chrono::duration<double>(1.0 / options.update_rate))) {
    bind();
    thread = std::thread([this] { serve(); });
  }
  ~Implementation() {
    context.stop();
    thread.join();
  }

  void bind() {
    error_code error;
    const auto address = asio::ip::make_address_v4(hub.address, error);
    if (error) {
      throw InputError(
          fmt::format("--listen {}: not an IPv4 address; e.g. 127.0.0.1", hub.address));
    }
    if (!address.is_loopback() && !hub.token.is_needed()) {
      throw InputError(fmt::format(
          "--listen {}: other machines could move a device on a finger; give --token FILE, a file "
          "with a secret that visitors must know",
          hub.address));
    }
    const tcp::endpoint endpoint(address, hub.port);
    acceptor.open(endpoint.protocol());
    acceptor.set_option(asio::socket_base::reuse_address(true));
    acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error == asio::error::address_in_use) {
      throw InputError(fmt::format(
          "--port {0}: already in use; take another, or --port 0 for any free one", hub.port));
    }
    if (error == asio::error::access_denied) {
      throw InputError(fmt::format(
          "--port {}: not permitted; take one above 1023, or --port 0 for any free one", hub.port));
    }
    if (error) {
      throw InputError(
          fmt::format("--listen {}: no such address here; e.g. 127.0.0.1", hub.address));
    }
    hub.port = acceptor.local_endpoint().port();
  }
  void serve() {
    asio::post(context, [this] {
      accept();
      next_update = std::chrono::steady_clock::now();
      schedule_update();
      update();
    });
    while (!context.stopped()) {
      try {
        context.run();
      } catch (const std::exception&) {
        // One connection's failure (out of memory, say) must not end the others.
      }
    }
  }
  void accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) {  // e.g. out of descriptors: wait for some to be free
        retry.expires_after(std::chrono::milliseconds(100));
        retry.async_wait([this](error_code) { accept(); });
        return;
      }
      accept();
      if (hub.connections < kMaxConnections) {
        error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        socket.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
        PageStream stream(std::move(socket), tls.get());
        std::make_shared<HttpSession>(std::move(stream), hub, watchers)->open();
      }
    });
  }
  void schedule_update() {
    next_update = std::max(next_update + period, std::chrono::steady_clock::now());
    update_timer.expires_at(next_update);
    update_timer.async_wait([this](error_code error) {
      if (error) return;
      schedule_update();
      update();
    });
  }
  void update() {
    auto description = hub.feed.description();
    if (description && description != hub.description) {
      const bool is_new =
          !hub.description || description->generation != hub.description->generation;
      hub.description = std::move(description);
      if (is_new) {
        hub.scene = std::make_shared<const std::string>(scene_message(*hub.description));
        hub.snapshot = nullptr;
        for_each_watcher([](WebSocketSession& session) { session.offer_scene(); });
      }
    }
    untold = hub.feed.refresh() || untold;
    tell_registration();
    // A snapshot of another generation waits for its description.
    if (!untold || !hub.description ||
        hub.feed.latest().generation != hub.description->generation) {
      return;
    }
    untold = false;
    auto message = std::make_shared<std::vector<std::byte>>();
    message->reserve(message_size);
    write_snapshot_message(hub.feed.latest(), *hub.description, *message);
    message_size = message->size();
    hub.snapshot = std::move(message);
    for_each_watcher([](WebSocketSession& session) { session.offer_snapshot(); });
  }
  void tell_registration() {
    const RegistrationState& state = hub.feed.registration();
    if (state.phase == RegistrationState::Phase::kIdle && !hub.registration) return;
    std::string message = registration_message(state);
    if (hub.registration && message == *hub.registration) return;
    hub.registration = std::make_shared<const std::string>(std::move(message));
    for_each_watcher([](WebSocketSession& session) { session.offer_registration(); });
  }
  template <typename Action>
  void for_each_watcher(const Action& action) {
    for (const auto& watcher : watchers) {
      if (const auto session = watcher.lock()) action(*session);
    }
  }

  // Connections point at the hub and are destroyed with the context: it comes after them.
  Hub hub;
  std::unique_ptr<asio::ssl::context> tls;  ///< null: plain
  Watchers watchers;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer retry{context};
  asio::steady_timer update_timer{context};
  std::chrono::steady_clock::duration period;
  std::chrono::steady_clock::time_point next_update;
  std::size_t message_size = 0;
  bool untold = false;  ///< the newest snapshot has not been sent yet
  std::thread thread;
};

Server::Server(LiveFeed& feed, const ServerOptions& options, std::span<const PageFile> page)
    : implementation_(std::make_unique<Implementation>(feed, options, page)) {}
Server::~Server() = default;

std::uint16_t Server::port() const { return implementation_->hub.port; }
std::string Server::url() const {
  const Hub& hub = implementation_->hub;
  return fmt::format("{}://{}:{}{}", hub.scheme,
                     hub.address == "0.0.0.0" ? "127.0.0.1" : hub.address, port(),
                     hub.token.is_needed() ? "/?token=" + hub.token.text() : "");
}

}  // namespace softfinger
