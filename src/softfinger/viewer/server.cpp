#include "softfinger/viewer/server.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "softfinger/viewer/events_message.hpp"
#include "softfinger/viewer/fit_message.hpp"
#include "softfinger/viewer/notification_message.hpp"
#include "softfinger/viewer/registration_message.hpp"
#include "softfinger/viewer/scene_message.hpp"
#include "softfinger/viewer/server/live_hub.hpp"
#include "softfinger/viewer/server/page_listener.hpp"
#include "softfinger/viewer/server/web_socket_session.hpp"
#include "softfinger/viewer/snapshot_message.hpp"

namespace softfinger {

namespace asio = boost::asio;
using boost::system::error_code;

struct Server::Implementation {
  Implementation(LiveFeed& feed, std::unique_ptr<PagePort::Implementation> bound,
                 std::span<const PageFile> page)
      : period(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
            std::chrono::duration<double>(1.0 / bound->options.update_rate))),
        hub(feed, page, bound->options, bound->tls != nullptr),
        listener(std::move(bound), hub) {
    listener.begin([this] {
      next_update = std::chrono::steady_clock::now();
      schedule_update();
      update();
    });
  }
  ~Implementation() { listener.end(); }

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
    for (const auto& watcher : hub.watchers) {
      if (const auto session = watcher.lock()) action(*session);
    }
  }

  std::chrono::steady_clock::duration period;
  std::chrono::steady_clock::time_point next_update;
  std::size_t message_size = 0;
  bool untold = false;  ///< the newest snapshot has not been sent yet
  LiveHub hub;
  PageListener listener;
  asio::steady_timer update_timer{listener.context()};
};

Server::Server(LiveFeed& feed, const ServerOptions& options, std::span<const PageFile> page)
    : Server(feed, PagePort(options), page) {}
Server::Server(LiveFeed& feed, PagePort port, std::span<const PageFile> page)
    : implementation_(
          std::make_unique<Implementation>(feed, std::move(port.implementation_), page)) {}
Server::~Server() = default;

std::uint16_t Server::port() const { return implementation_->hub.port; }
std::string Server::url() const { return implementation_->hub.url(); }

}  // namespace softfinger
