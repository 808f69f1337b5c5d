#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "softfinger/viewer/server.hpp"

namespace {

using namespace softfinger;

constexpr int kPatienceMs = 200;
constexpr int kVisitorsEvery = 64;
constexpr std::string_view kHostInSeeds = "127.0.0.1:8080";

/// A scene with nothing in it that takes what it is asked.
class EmptyFeed final : public LiveFeed {
 public:
  std::shared_ptr<const SceneDescription> description() override { return description_; }
  bool refresh() override {
    ++snapshot_.step;
    return true;
  }
  const Snapshot& latest() const override { return snapshot_; }
  void request(const LiveRequest&) override {}
  void offer_hand(const XrHand&) override {}

 private:
  std::shared_ptr<const SceneDescription> description_ = std::make_shared<SceneDescription>();
  Snapshot snapshot_;
};

/// A connection; empty where there is none to be had at the moment.
std::optional<int> try_to_connect(std::uint16_t port) {
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(descriptor, std::bit_cast<sockaddr*>(&address), sizeof address) != 0) {
    std::fprintf(stderr, "connect: %s\n", std::strerror(errno));
    ::close(descriptor);
    return std::nullopt;
  }
  // Closed at once: thousands of connections leave no port waiting.
  const linger at_once{1, 0};
  ::setsockopt(descriptor, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  return descriptor;
}

int connection_to(std::uint16_t port) {
  // Ends that the server closed first keep this machine's ports for a minute.
  for (int i = 0; i < 90; ++i) {
    if (const auto descriptor = try_to_connect(port)) return *descriptor;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  __builtin_trap();  // it no longer listens
}

/// What the server says to `bytes` and their end, as far as it comes in time.
std::string answer_to(std::string_view bytes, std::uint16_t port) {
  const int descriptor = connection_to(port);
  ::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  ::shutdown(descriptor, SHUT_WR);
  std::string answer;
  std::array<char, 4096> chunk{};
  pollfd readable{.fd = descriptor, .events = POLLIN, .revents = 0};
  while (answer.size() < 100'000 && ::poll(&readable, 1, kPatienceMs) > 0) {
    const ssize_t got = ::recv(descriptor, chunk.data(), chunk.size(), 0);
    if (got <= 0) break;
    answer.append(chunk.data(), static_cast<std::size_t>(got));
  }
  ::close(descriptor);
  return answer;
}

}  // namespace

// Whatever a client sends, HTTP or WebSocket frames after it: the server goes on and serves the
// next visitor.
extern "C" int fuzz_server(const std::uint8_t* data, std::size_t size) {
  static EmptyFeed feed;
  static constexpr std::array<PageFile, 1> kPage = {{{"/index.html", "text/html", "softfinger"}}};
  static Server server(feed, {.port = 0}, kPage);
  static const std::string host = "127.0.0.1:" + std::to_string(server.port());
  static int visits = 0;

  std::string bytes(reinterpret_cast<const char*>(data), size);
  for (auto at = bytes.find(kHostInSeeds); at != std::string::npos;
       at = bytes.find(kHostInSeeds, at + host.size())) {
    bytes.replace(at, kHostInSeeds.size(), host);
  }
  (void)answer_to(bytes, server.port());
  if (++visits % kVisitorsEvery == 0) {
    const std::string page = answer_to(
        "GET / HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n", server.port());
    if (!page.starts_with("HTTP/1.1 200") || !page.ends_with("softfinger")) __builtin_trap();
  }
  return 0;
}
