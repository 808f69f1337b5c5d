#include "softfinger/viewer/server/web_socket_session.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <string>

#include "softfinger/viewer/hand_message.hpp"
#include "softfinger/viewer/notification_message.hpp"
#include "softfinger/viewer/page_request.hpp"

namespace softfinger {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;

namespace {

constexpr auto kIdleTimeout = std::chrono::minutes(5);
/// Two hands at 144 Hz are 288 a second.
constexpr double kMostMessagesPerSecond = 600.0;
/// What was held up on the way comes all at once.
constexpr double kMostMessagesAtOnce = 4000.0;
/// That wait for a slow page.
constexpr std::size_t kMostNotifications = 32;
constexpr std::size_t kMostEvents = 64;

}  // namespace

WebSocketSession::WebSocketSession(PageStream&& stream, LiveHub& hub, ConnectionCount&& count)
    : hub_(hub), count_(std::move(count)), socket_(std::move(stream)) {}

WebSocketSession::~WebSocketSession() {
  if (hub_.mover == this) hub_.mover = nullptr;
}

void WebSocketSession::accept(const HttpRequest& request) {
  beast::get_lowest_layer(socket_).expires_never();
  socket_.set_option(websocket::stream_base::timeout{PageHub::kHttpTimeout, kIdleTimeout, true});
  socket_.read_message_max(PageHub::kMaxRequestBytes);
  socket_.auto_fragment(false);  // one message, one frame: easy to read for other clients
  socket_.async_accept(request, [self = shared_from_this()](error_code error) {
    if (error) return;
    self->open_ = true;
    self->offer_scene();
    self->offer_registration();
    self->offer_fit();
    if (!self->hub_.loading.empty()) self->offer_loading();
    self->offer_snapshot();
    self->read();
  });
}

void WebSocketSession::offer_scene() {
  next_scene_ = hub_.scene;
  next_snapshot_ = nullptr;  // of the scene before
  next_events_.clear();
  write();
}

void WebSocketSession::offer_registration() {
  next_registration_ = hub_.registration;
  write();
}

void WebSocketSession::offer_fit() {
  next_fit_ = hub_.fit;
  write();
}

void WebSocketSession::offer_loading() {
  next_loading_ = std::make_shared<const std::string>(loading_message(hub_.loading));
  write();
}

void WebSocketSession::offer_snapshot() {
  next_snapshot_ = hub_.snapshot;
  write();
}

void WebSocketSession::notify(LiveHub::Text message) {
  if (next_notifications_.size() < kMostNotifications) {
    next_notifications_.push_back(std::move(message));
  }
  write();
}

void WebSocketSession::tell_events(LiveHub::Text message) {
  if (next_events_.size() < kMostEvents) next_events_.push_back(std::move(message));
  write();
}

void WebSocketSession::write() {
  if (writing_ || !open_) return;
  for (LiveHub::Text* next : {&next_scene_, &next_registration_, &next_fit_, &next_loading_}) {
    if (*next) return send_text(std::exchange(*next, nullptr));
  }
  for (auto* waiting : {&next_notifications_, &next_events_}) {
    if (waiting->empty()) continue;
    LiveHub::Text next = std::move(waiting->front());
    waiting->pop_front();
    return send_text(std::move(next));
  }
  if (!next_snapshot_) return;
  snapshot_in_flight_ = std::exchange(next_snapshot_, nullptr);
  socket_.binary(true);
  send(asio::buffer(*snapshot_in_flight_));
}

void WebSocketSession::send_text(LiveHub::Text message) {
  text_in_flight_ = std::move(message);
  socket_.text(true);
  send(asio::buffer(*text_in_flight_));
}

void WebSocketSession::send(asio::const_buffer message) {
  writing_ = true;
  socket_.async_write(message, [self = shared_from_this()](error_code error, std::size_t) {
    self->writing_ = false;
    self->open_ = self->open_ && !error;
    self->write();
  });
}

void WebSocketSession::read() {
  buffer_.clear();
  socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) {
      self->open_ = false;
      return;
    }
    self->obey();
  });
}

void WebSocketSession::obey() {
  const auto data = buffer_.cdata();
  const std::string_view message(static_cast<const char*>(data.data()), data.size());
  if (is_flood()) return refuse("more than any page sends");
  // Nothing waits here: of queued hands only the newest counts, and a stop waits for none of them.
  if (socket_.got_text() ? obey_request(message) : obey_hand(message)) return read();
  refuse("not a request of the live page");
}

bool WebSocketSession::is_flood() {
  const auto now = std::chrono::steady_clock::now();
  const std::chrono::duration<double> since = now - last_message_;
  last_message_ = now;
  messages_ = std::max(0.0, messages_ - kMostMessagesPerSecond * since.count()) + 1.0;
  return messages_ > kMostMessagesAtOnce;
}

void WebSocketSession::refuse(const char* reason) {
  open_ = false;
  socket_.async_close({websocket::close_code::policy_error, reason},
                      [self = shared_from_this()](error_code) {});
}

bool WebSocketSession::obey_request(std::string_view message) {
  const auto& scene = hub_.description;
  const auto request = parse_page_request(
      message, scene ? std::span(scene->scene_names) : std::span<const std::string>());
  if (!request) return false;
  using Kind = LiveRequest::Kind;
  const bool moves =
      request->kind == Kind::kPose || request->kind == Kind::kHold || request->kind == Kind::kLetGo;
  if (!moves || is_mover()) hub_.feed.request(*request);
  return true;
}

bool WebSocketSession::obey_hand(std::string_view message) {
  const auto hand = parse_hand_message(message);
  if (hand && is_mover()) hub_.feed.offer_hand(*hand);
  return hand.has_value();
}

bool WebSocketSession::is_mover() {
  if (hub_.mover == nullptr) hub_.mover = this;
  return hub_.mover == this;
}

}  // namespace softfinger
