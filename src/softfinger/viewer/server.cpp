#include "softfinger/viewer/server.hpp"

#include <boost/asio/post.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "softfinger/viewer/events_message.hpp"
#include "softfinger/viewer/fit_message.hpp"
#include "softfinger/viewer/notification_message.hpp"
#include "softfinger/viewer/own_address.hpp"
#include "softfinger/viewer/registration_message.hpp"
#include "softfinger/viewer/scene_message.hpp"
#include "softfinger/viewer/server/bound_port.hpp"
#include "softfinger/viewer/server/http_session.hpp"
#include "softfinger/viewer/snapshot_message.hpp"

namespace softfinger {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr int kSendBufferBytes = 64 * 1024;  // small: what waits in it is no longer the newest

}  // namespace

struct Server::Implementation {
  Implementation(LiveFeed& feed, std::unique_ptr<PagePort::Implementation> bound,
                 std::span<const PageFile> page)
      : hub{feed,
            page,
            bound->options.token,
            bound->options.address,
            bound->tls ? "https" : "http",
            bound->options.port},
        port(std::move(bound)),
        period(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
            std::chrono::duration<double>(1.0 / port->options.update_rate))) {
    thread = std::thread([this] { serve(); });
  }
  ~Implementation() {
    context.stop();
    thread.join();
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
      error_code ignored;
      const asio::ip::address visitor = socket.remote_endpoint(ignored).address();
      if (hub.has_room_for(visitor)) {
        socket.set_option(tcp::no_delay(true), ignored);
        socket.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
        PageStream stream(std::move(socket), port->tls.get());
        std::make_shared<HttpSession>(std::move(stream), hub, watchers, visitor)->open();
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
    tell_fit();
    tell_loading();
    notify_people();
    // A snapshot of another generation waits for its description.
    if (!untold || !hub.description ||
        hub.feed.latest().generation != hub.description->generation) {
      return;
    }
    tell_events();
    untold = false;
    auto message = std::make_shared<std::vector<std::byte>>();
    message->reserve(message_size);
    write_snapshot_message(hub.feed.latest(), *hub.description, *message);
    message_size = message->size();
    hub.snapshot = std::move(message);
    for_each_watcher([](WebSocketSession& session) { session.offer_snapshot(); });
  }
  /// Before the snapshot that follows them.
  void tell_events() {
    std::vector<LiveEvent> events;
    while (auto event = hub.feed.take_event()) events.push_back(std::move(*event));
    if (events.empty()) return;
    const auto message =
        std::make_shared<const std::string>(events_message(hub.description->generation, events));
    for_each_watcher([&](WebSocketSession& session) { session.tell_events(message); });
  }
  void tell_registration() {
    const RegistrationState& state = hub.feed.registration();
    if (state.phase == RegistrationState::Phase::kIdle && !hub.registration) return;
    std::string message = registration_message(state);
    if (hub.registration && message == *hub.registration) return;
    hub.registration = std::make_shared<const std::string>(std::move(message));
    for_each_watcher([](WebSocketSession& session) { session.offer_registration(); });
  }
  void tell_fit() {
    const FitState state = hub.feed.fit();
    if (state.phase == FitState::Phase::kIdle && !hub.fit) return;
    std::string message = fit_message(state);
    if (hub.fit && message == *hub.fit) return;
    hub.fit = std::make_shared<const std::string>(std::move(message));
    for_each_watcher([](WebSocketSession& session) { session.offer_fit(); });
  }
  void tell_loading() {
    std::string scene = hub.feed.loading();
    if (scene == hub.loading) return;
    hub.loading = std::move(scene);
    for_each_watcher([](WebSocketSession& session) { session.offer_loading(); });
  }
  void notify_people() {
    std::vector<std::string> lines;
    while (auto line = hub.feed.take_message()) lines.push_back(std::move(*line));
    if (lines.empty()) return;
    const auto message = std::make_shared<const std::string>(notification_message(lines));
    for_each_watcher([&](WebSocketSession& session) { session.notify(message); });
  }
  template <typename Action>
  void for_each_watcher(const Action& action) {
    for (const auto& watcher : watchers) {
      if (const auto session = watcher.lock()) action(*session);
    }
  }

  // Connections point at the hub and are destroyed with the context: it comes after them.
  PageHub hub;
  Watchers watchers;
  std::unique_ptr<PagePort::Implementation> port;
  asio::io_context& context = port->context;
  tcp::acceptor& acceptor = port->acceptor;
  asio::steady_timer retry{context};
  asio::steady_timer update_timer{context};
  std::chrono::steady_clock::duration period;
  std::chrono::steady_clock::time_point next_update;
  std::size_t message_size = 0;
  bool untold = false;  ///< the newest snapshot has not been sent yet
  std::thread thread;
};

Server::Server(LiveFeed& feed, const ServerOptions& options, std::span<const PageFile> page)
    : Server(feed, PagePort(options), page) {}
Server::Server(LiveFeed& feed, PagePort port, std::span<const PageFile> page)
    : implementation_(
          std::make_unique<Implementation>(feed, std::move(port.implementation_), page)) {}
Server::~Server() = default;

std::uint16_t Server::port() const { return implementation_->hub.port; }
std::string Server::url() const {
  const PageHub& hub = implementation_->hub;
  std::vector<std::string> urls;
  for (const std::string& address : hub.address == "0.0.0.0"
                                        ? addresses_of_this_machine()
                                        : std::vector<std::string>{hub.address}) {
    urls.push_back(fmt::format("{}://{}:{}{}", hub.scheme, address, port(),
                               hub.token.is_needed() ? "/?token=" + hub.token.text() : ""));
  }
  return fmt::format("{}", fmt::join(urls, " or "));
}

}  // namespace softfinger
