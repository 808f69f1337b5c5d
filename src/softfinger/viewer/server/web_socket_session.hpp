#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

#include <chrono>
#include <deque>
#include <memory>
#include <string_view>

#include "softfinger/viewer/server/live_hub.hpp"
#include "softfinger/viewer/server/page_stream.hpp"

namespace softfinger {

/// One page that watches. Holds at most one message being sent, and the newest ones to send next.
class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(PageStream&& stream, LiveHub& hub, ConnectionCount&& count);
  ~WebSocketSession();
  WebSocketSession(const WebSocketSession&) = delete;
  WebSocketSession& operator=(const WebSocketSession&) = delete;

  void accept(const HttpRequest& request);
  // What the hub has now.
  void offer_scene();
  void offer_registration();
  void offer_fit();
  void offer_loading();
  void offer_snapshot();
  /// What people are told. Waits for its turn, but for the last of very many.
  void notify(LiveHub::Text message);
  void tell_events(LiveHub::Text message);

 private:
  void write();
  void send_text(LiveHub::Text message);
  void send(boost::asio::const_buffer message);
  void read();
  void obey();
  bool obey_request(std::string_view message);
  bool obey_hand(std::string_view message);
  /// Whether this page moves the fingers, now that it wants to.
  bool is_mover();
  [[nodiscard]] bool is_flood();
  void refuse(const char* reason);

  LiveHub& hub_;
  ConnectionCount count_;
  boost::beast::websocket::stream<PageStream> socket_;
  boost::beast::flat_buffer buffer_{PageHub::kMaxRequestBytes};
  LiveHub::Text next_scene_, next_registration_, next_fit_, next_loading_;
  std::deque<LiveHub::Text> next_notifications_;  ///< each is told once
  std::deque<LiveHub::Text> next_events_;         ///< likewise; they keep no notification waiting
  LiveHub::Text text_in_flight_;
  LiveHub::Bytes next_snapshot_, snapshot_in_flight_;
  bool open_ = false;
  bool writing_ = false;
  std::chrono::steady_clock::time_point last_message_;
  double messages_ = 0.0;  ///< beyond what a page may send all the time
};

}  // namespace softfinger
