#include "visitors.hpp"

#include <chrono>
#include <deque>
#include <exception>
#include <memory>
#include <string>

#include "raw_client.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

constexpr int kKinds = 5;
constexpr std::size_t kStay = 40;  // of each kind; together two hundred

}  // namespace

Visitors::Visitors(std::uint16_t port) : port_(port) {
  for (int kind = 0; kind < kKinds; ++kind) {
    threads_.emplace_back([this, kind] { keep_coming(kind); });
  }
}

Visitors::~Visitors() {
  ending_ = true;
  for (std::thread& thread : threads_) thread.join();
}

void Visitors::keep_coming(int kind) {
  std::deque<std::unique_ptr<RawClient>> staying;
  while (!ending_) {
    try {
      auto client = std::make_unique<RawClient>(port_, 16 * 1024);
      if (kind == 0) {  // looks for a moment
        if (client->open_web_socket().status == 101) (void)client->read_frame(2);
      } else if (kind == 1) {  // asks for a page with the longest address
        client->send("GET /" + std::string(20'000, 'x') + " HTTP/1.1\r\n\r\n");
      } else if (kind == 2) {  // half a request
        client->send("GET /ws HTTP/1.1\r\nHost: 127.0");
      } else if (kind == 3) {  // never reads what it asked for
        (void)client->open_web_socket();
      } else if (client->open_web_socket().status == 101) {  // no request of the page
        client->send_frame(1, std::string(60'000, 'x'));
      }
      staying.push_back(std::move(client));
      ++came_;
    } catch (const std::exception&) {
      // The server's queue is full: comes again.
    }
    if (staying.size() > kStay || (kind == 0 && !staying.empty())) staying.pop_front();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void Watcher::watch(std::uint16_t port) {
  RawClient client(port);
  if (client.open_web_socket().status != 101) return;
  double last = monotonic_time();
  while (client.read_frame(2)) {
    const double now = monotonic_time();
    if (pictures_ > 0) longest_gap_ = std::max(longest_gap_.load(), now - last);
    last = now;
    ++pictures_;
  }
}

}  // namespace softfinger
