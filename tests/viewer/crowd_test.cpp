// Two hundred visitors that come and go, some of them slow, silent or hostile: a page that watches
// is served all the time, and nothing of them stays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <deque>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "raw_client.hpp"
#include "softfinger/viewer/server.hpp"
#include "synthetic_feed.hpp"

namespace softfinger {
namespace {

constexpr std::array<PageFile, 1> kCrowdsPage{
    {{"/index.html", "text/html; charset=utf-8", "<p>page"}}};
constexpr int kVisitors = 200;
constexpr int kAtOnce = 4;         // threads of visitors
constexpr std::size_t kStay = 20;  // of each; together more than the server takes

std::size_t open_descriptors() {
  return static_cast<std::size_t>(std::distance(
      std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator()));
}

double snapshot_time(const WebSocketFrame& frame) {
  double time = 0.0;
  frame.payload.copy(std::bit_cast<char*>(&time), sizeof time, 16);
  return time;
}

/// One visit; a client that stays on without a word is given back. A server that is full closes.
std::unique_ptr<RawClient> visit(std::uint16_t port, int number) {
  auto client = std::make_unique<RawClient>(port, /*receive_buffer=*/16 * 1024);
  switch (number % 8) {
    case 0:  // looks for a moment and leaves
      if (client->open_web_socket().status == 101) (void)client->read_frame(2);
      return nullptr;
    case 1:  // loads the page and leaves
      (void)client->get("/");
      return nullptr;
    case 2:  // says nothing
      return client;
    case 3:  // stops in the middle of a request
      client->send("GET /ws HTTP/1.1\r\nHost: 127.0");
      return client;
    case 4:  // never reads what it asked for
      (void)client->open_web_socket();
      return client;
    case 5:  // half a frame
      if (client->open_web_socket().status == 101) client->send("\x81\xfe\x03");
      return client;
    case 6:  // no request of the page, and longer than any
      if (client->open_web_socket().status == 101) client->send_frame(1, std::string(60'000, 'x'));
      return nullptr;
    default:  // no HTTP at all
      client->send(std::string(20'000, '\xff') + "\r\n\r\n");
      return nullptr;
  }
}

TEST(Crowd, DelaysNobodyAndLeavesNothing) {
  SyntheticFeed feed;
  Server server(feed, {.port = 0}, kCrowdsPage);
  auto watching = std::make_unique<RawClient>(server.port());
  ASSERT_EQ(watching->open_web_socket().status, 101);
  ASSERT_TRUE(watching->read_frame(2));
  const std::size_t descriptors = open_descriptors();

  std::atomic<int> next{0};
  std::atomic<int> crowding{kAtOnce};
  std::vector<std::thread> crowd;
  for (int i = 0; i < kAtOnce; ++i) {
    crowd.emplace_back([&] {
      std::deque<std::unique_ptr<RawClient>> staying;
      for (int number = next++; number < kVisitors; number = next++) {
        if (auto client = visit(server.port(), number)) staying.push_back(std::move(client));
        if (staying.size() > kStay) staying.pop_front();
      }
      --crowding;
    });
  }
  double newest = 0.0;
  int frames = 0;
  std::size_t most_descriptors = 0;
  while (crowding > 0 || frames < 30) {
    const auto frame = watching->read_frame(2);
    ASSERT_TRUE(frame) << "the page that was there first is no longer served";
    EXPECT_GT(snapshot_time(*frame), newest) << "always newer ones";
    newest = snapshot_time(*frame);
    ++frames;
    most_descriptors = std::max(most_descriptors, open_descriptors());
  }
  for (std::thread& visitors : crowd) visitors.join();
  // Their own ends, and at most 64 of the server's with one that is being turned away.
  EXPECT_LE(most_descriptors, descriptors + kAtOnce * (kStay + 2) + 64 + kAtOnce);
  EXPECT_TRUE(feed.requests().empty());

  // They have left, and there is room again.
  int status = 0;
  for (int i = 0; i < 500 && status != 200; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    status = RawClient(server.port()).get("/").status;
  }
  EXPECT_EQ(status, 200);
  for (int i = 0; i < 500 && open_descriptors() > descriptors; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_LE(open_descriptors(), descriptors);
}

}  // namespace
}  // namespace softfinger
