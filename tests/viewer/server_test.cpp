#include "softfinger/viewer/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <chrono>
#include <thread>

#include "raw_client.hpp"
#include "softfinger/base/error.hpp"
#include "synthetic_feed.hpp"

namespace softfinger {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Clock = std::chrono::steady_clock;

constexpr std::array<PageFile, 2> kPage{{
    {"/index.html", "text/html; charset=utf-8", "<p>page"},
    {"/assets/page.css", "text/css; charset=utf-8", "p {}"},
}};

class ServerTest : public ::testing::Test {
 protected:
  std::string own(std::string_view field, std::string_view host = "127.0.0.1") {
    return std::string(field) + std::string(host) + ":" + std::to_string(server.port()) + "\r\n";
  }
  int status_of(const std::string& request) {
    RawClient client(server.port());
    client.send(request);
    return client.read_answer().status;
  }

  SyntheticFeed feed;
  Server server{feed, {.port = 0}, kPage};
};

TEST_F(ServerTest, ServesThePage) {
  ASSERT_NE(server.port(), 0);
  EXPECT_EQ(server.url(), "http://127.0.0.1:" + std::to_string(server.port()));
  RawClient client(server.port());
  const HttpAnswer page = client.get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<p>page");
  EXPECT_THAT(page.header, HasSubstr("Content-Type: text/html; charset=utf-8\r\n"));
  EXPECT_THAT(page.header, HasSubstr("Content-Security-Policy: default-src 'self'"));
  // The same connection goes on.
  EXPECT_THAT(client.get("/assets/page.css?v=1").header,
              HasSubstr("Content-Type: text/css; charset=utf-8\r\n"));
  EXPECT_EQ(client.get("/?a=b").status, 200);
  EXPECT_EQ(client.get("/missing").status, 404);
  EXPECT_EQ(client.get("/../../etc/passwd").status, 404);
  EXPECT_EQ(client.get("/").body, "<p>page");
}

TEST_F(ServerTest, HeadHasNoBody) {
  RawClient client(server.port());
  client.send("HEAD / HTTP/1.1\r\n" + own("Host: ") + "\r\n");
  const HttpAnswer head = client.read_answer(/*has_body=*/false);
  EXPECT_EQ(head.status, 200);
  EXPECT_THAT(head.header, HasSubstr("Content-Length: 7\r\n"));
  EXPECT_EQ(client.get("/").body, "<p>page");
}

TEST_F(ServerTest, OtherMethodsAreRefused) {
  EXPECT_EQ(status_of("DELETE / HTTP/1.1\r\n" + own("Host: ") + "\r\n"), 405);
  EXPECT_EQ(status_of("POST / HTTP/1.1\r\n" + own("Host: ") + "Content-Length: 2\r\n\r\nhi"), 413);
}

TEST_F(ServerTest, ForeignHostsAndOriginsAreRefused) {
  const std::string get = "GET / HTTP/1.1\r\n";
  EXPECT_EQ(status_of(get + own("Host: ", "localhost") + "\r\n"), 200);
  EXPECT_EQ(status_of(get + own("Host: ") + own("Origin: http://", "localhost") + "\r\n"), 200);
  EXPECT_EQ(status_of(get + "\r\n"), 403);
  EXPECT_EQ(status_of(get + own("Host: ", "example.org") + "\r\n"), 403);
  EXPECT_EQ(status_of(get + "Host: 127.0.0.1\r\n\r\n"), 403);
  EXPECT_EQ(status_of(get + own("Host: ") + own("Host: ") + "\r\n"), 403);
  EXPECT_EQ(status_of(get + own("Host: ") + "Origin: http://example.org\r\n\r\n"), 403);
  EXPECT_EQ(status_of(get + own("Host: ") + "Origin: null\r\n\r\n"), 403);
  RawClient client(server.port());
  EXPECT_EQ(client.open_web_socket("Origin: http://example.org\r\n").status, 403);
}

TEST_F(ServerTest, SizesAreBounded) {
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\n" + own("Host: ") + "A: " + std::string(20000, 'x') +
                      "\r\n\r\n"),
            431);
  EXPECT_EQ(status_of("GET /" + std::string(20000, 'x') + " HTTP/1.1\r\n\r\n"), 431);
  EXPECT_EQ(status_of("nonsense\r\n\r\n"), 400);
}

TEST_F(ServerTest, ConnectionsAreBounded) {
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 64; ++i) {
    clients.push_back(std::make_unique<RawClient>(server.port()));
    ASSERT_EQ(clients.back()->get("/").status, 200);
  }
  EXPECT_TRUE(RawClient(server.port()).is_closed());
  clients.clear();
  // Room again once they have left.
  int status = 0;
  for (int i = 0; i < 100 && status != 200; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    status = RawClient(server.port()).get("/").status;
  }
  EXPECT_EQ(status, 200);
}

TEST_F(ServerTest, WebSocketNeedsAnUpgrade) {
  RawClient client(server.port());
  EXPECT_EQ(client.get("/ws").status, 426);
}

TEST_F(ServerTest, SendsTheSceneThenSnapshots) {
  RawClient client(server.port());
  const HttpAnswer handshake = client.open_web_socket(own("Origin: http://"));
  EXPECT_EQ(handshake.status, 101);
  // The answer to the key of RFC 6455's own example.
  EXPECT_THAT(handshake.header, HasSubstr("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="));
  const auto scene = client.read_frame();
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->opcode, 1);
  EXPECT_THAT(scene->payload, StartsWith(R"({"type":"scene")"));
  double last = -1;
  for (int i = 0; i < 5; ++i) {
    const auto snapshot = client.read_frame();
    ASSERT_TRUE(snapshot);
    ASSERT_EQ(snapshot->opcode, 2);
    EXPECT_EQ(snapshot->payload.substr(0, 4), "SFSA");
    double time = 0;
    snapshot->payload.copy(std::bit_cast<char*>(&time), sizeof time, 16);
    EXPECT_GT(time, last);
    last = time;
  }
}

TEST_F(ServerTest, SixtyUpdatesASecond) {
  RawClient client(server.port());
  ASSERT_EQ(client.open_web_socket().status, 101);
  ASSERT_TRUE(client.read_frame(2));
  const auto start = Clock::now();
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(client.read_frame(2));
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  EXPECT_GT(seconds, 0.9);
  EXPECT_LT(seconds, 3.0);  // a loaded machine may be late, not early
}

TEST_F(ServerTest, RequestsReachTheFeed) {
  RawClient client(server.port());
  ASSERT_EQ(client.open_web_socket().status, 101);
  client.send_frame(1, R"({"request":"pause"})");
  client.send_frame(1, R"({"request":"scene","scene":"edge"})");
  // The new scene comes as text, before its first snapshot.
  auto frame = client.read_frame(1);
  while (frame && frame->payload.find(R"("scene":"edge")") == std::string::npos) {
    frame = client.read_frame(1);
  }
  ASSERT_TRUE(frame);
  const auto snapshot = client.read_frame();
  ASSERT_TRUE(snapshot);
  EXPECT_EQ(snapshot->opcode, 2);
  EXPECT_EQ(snapshot->payload[4], 2);  // its generation
  const auto requests = feed.requests();
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_EQ(requests[0].kind, LiveRequest::Kind::kPause);
  EXPECT_EQ(requests[1].scene, "edge");
}

TEST_F(ServerTest, RegistrationIsToldToEveryPageOnceItIsAskedFor) {
  RawClient client(server.port());
  ASSERT_EQ(client.open_web_socket().status, 101);
  ASSERT_TRUE(client.read_frame(2));
  client.send_frame(1, R"({"request":"register","finger":0})");
  const auto running = client.read_frame(1);
  ASSERT_TRUE(running);
  EXPECT_NE(running->payload.find(R"("state":"running")"), std::string::npos) << running->payload;
  EXPECT_NE(running->payload.find(R"("posture":"left side","words":"Roll it.")"),
            std::string::npos);
  RawClient late(server.port());
  ASSERT_EQ(late.open_web_socket().status, 101);
  ASSERT_TRUE(late.read_frame(1));  // the scene
  EXPECT_EQ(late.read_frame(1)->payload, running->payload);
  client.send_frame(1, R"({"request":"cancel_registration"})");
  EXPECT_NE(late.read_frame(1)->payload.find(R"("state":"idle")"), std::string::npos);
}

TEST_F(ServerTest, AFitIsToldToEveryPageOnceItIsAskedFor) {
  RawClient client(server.port());
  ASSERT_EQ(client.open_web_socket().status, 101);
  ASSERT_TRUE(client.read_frame(2));
  client.send_frame(1, R"({"request":"fit","finger":0})");
  const auto pressing = client.read_frame(1);
  ASSERT_TRUE(pressing);
  EXPECT_EQ(pressing->payload,
            R"({"type":"fit","state":"pressing","finger":0,"by_touch":false,"press":3,"of":9,)"
            R"("words":"Turned by +20 degrees of pitch and +20 of roll.","force_N":0.41,)"
            R"("progress":0.2,"message":""})");
  RawClient late(server.port());
  ASSERT_EQ(late.open_web_socket().status, 101);
  ASSERT_TRUE(late.read_frame(1));  // the scene
  EXPECT_EQ(late.read_frame(1)->payload, pressing->payload);
  client.send_frame(1, R"({"request":"cancel_fit"})");
  EXPECT_NE(late.read_frame(1)->payload.find(R"("state":"idle")"), std::string::npos);
}

TEST_F(ServerTest, WhatPeopleAreToldIsToldOnEveryPage) {
  RawClient one(server.port()), other(server.port());
  ASSERT_EQ(one.open_web_socket().status, 101);
  ASSERT_EQ(other.open_web_socket().status, 101);
  ASSERT_TRUE(one.read_frame(2));
  ASSERT_TRUE(other.read_frame(2));
  feed.say("port /dev/tty\xff went \"away\"");
  for (RawClient* client : {&one, &other}) {
    const auto told = client->read_frame(1);
    ASSERT_TRUE(told);
    EXPECT_EQ(
        told->payload,
        "{\"type\":\"notifications\",\"lines\":[\"port /dev/tty\xef\xbf\xbd went \\\"away\\\"\"]}");
  }
}

TEST_F(ServerTest, ASlowPageMissesNothingThatPeopleAreTold) {
  RawClient slow(server.port(), 4096);
  ASSERT_EQ(slow.open_web_socket().status, 101);
  ASSERT_TRUE(slow.read_frame(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // until no more fits on the way
  for (const char* line : {"one", "two", "three"}) {
    feed.say(line);
    std::this_thread::sleep_for(std::chrono::milliseconds(60));  // an update of its own
  }
  for (const char* line : {"one", "two", "three"}) {
    const auto told = slow.read_frame(1);
    ASSERT_TRUE(told);
    EXPECT_THAT(told->payload, HasSubstr(line));
  }
}

TEST_F(ServerTest, ASceneThatIsBeingLoadedIsToldOnEveryPage) {
  RawClient one(server.port());
  ASSERT_EQ(one.open_web_socket().status, 101);
  ASSERT_TRUE(one.read_frame(2));
  feed.set_loading("edge");
  EXPECT_EQ(one.read_frame(1)->payload, R"({"type":"loading","scene":"edge"})");
  RawClient late(server.port());
  ASSERT_EQ(late.open_web_socket().status, 101);
  ASSERT_TRUE(late.read_frame(1));  // the scene
  EXPECT_EQ(late.read_frame(1)->payload, R"({"type":"loading","scene":"edge"})");
  feed.set_loading("");
  EXPECT_EQ(late.read_frame(1)->payload, R"({"type":"loading","scene":""})");
}

TEST_F(ServerTest, OnePageMovesFingersAtATime) {
  const auto pose = [](int z) {
    return R"({"request":"pose","finger":0,"position_mm":[0,0,)" + std::to_string(z) +
           R"(],"quaternion":[1,0,0,0]})";
  };
  const auto wait_for = [this](std::size_t count) {
    for (int i = 0; i < 1000 && feed.requests().size() < count; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return feed.requests();
  };
  RawClient second(server.port());
  ASSERT_EQ(second.open_web_socket().status, 101);
  {
    RawClient first(server.port());
    ASSERT_EQ(first.open_web_socket().status, 101);
    first.send_frame(1, pose(1));
    ASSERT_EQ(wait_for(1).size(), 1U);
    second.send_frame(1, pose(2));
    second.send_frame(
        1, R"({"request":"hold","object":"a","position_mm":[0,0,0],"quaternion":[1,0,0,0]})");
    second.send_frame(1, R"({"request":"let_go","object":"a"})");
    second.send_frame(1, R"({"request":"pause"})");
    const auto requests = wait_for(2);
    ASSERT_EQ(requests.size(), 2U);
    EXPECT_DOUBLE_EQ(requests[0].X_W.translation.z(), 1e-3);
    EXPECT_EQ(requests[1].kind, LiveRequest::Kind::kPause) << "nothing of the second page moves";
  }
  // The first is gone: whoever is there may.
  std::vector<LiveRequest> requests;
  for (int i = 0; i < 100 && requests.size() < 3; ++i) {
    second.send_frame(1, pose(3));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    requests = feed.requests();
  }
  ASSERT_GE(requests.size(), 3U);
  EXPECT_DOUBLE_EQ(requests.back().X_W.translation.z(), 3e-3);
}

TEST_F(ServerTest, HandsOfAHeadsetReachTheFeedFromOnePage) {
  // The right hand, not tracked, at 1000 and 1016 ms.
  constexpr std::string_view kFirst("SFHX\0\0\0\0\0\0\0\0\0\x40\x8f\x40", 16);
  constexpr std::string_view kSecond("SFHX\0\0\0\0\0\0\0\0\0\xc0\x8f\x40", 16);
  RawClient first(server.port());
  RawClient second(server.port());
  ASSERT_EQ(first.open_web_socket().status, 101);
  ASSERT_EQ(second.open_web_socket().status, 101);
  const auto wait_for_hands = [this](std::size_t count) {
    for (int i = 0; i < 1000 && feed.hands().size() < count; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return feed.hands();
  };
  first.send_frame(2, kFirst);
  ASSERT_EQ(wait_for_hands(1).size(), 1U);
  second.send_frame(2, kFirst);
  second.send_frame(1, R"({"request":"pause"})");
  for (int i = 0; i < 1000 && feed.requests().empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  first.send_frame(2, kSecond);
  const auto hands = wait_for_hands(2);
  ASSERT_EQ(hands.size(), 2U) << "none of the second page";
  EXPECT_DOUBLE_EQ(hands[0].time, 1.0);
  EXPECT_DOUBLE_EQ(hands[1].time, 1.016);
}

// A link that stalled and is back brings all that it held up at once.
TEST_F(ServerTest, AStopWaitsForNoQueuedHand) {
  constexpr std::string_view kHand("SFHX\0\0\0\0\0\0\0\0\0\x40\x8f\x40", 16);
  RawClient client(server.port());
  client.open_web_socket(own("Origin: http://"));
  for (int k = 0; k < 2000; ++k) client.send_frame(2, kHand);
  const auto began = std::chrono::steady_clock::now();
  client.send_frame(1, R"({"request":"stop"})");
  const auto stopped = [this] {
    const auto requests = feed.requests();
    return !requests.empty() && requests.back().kind == LiveRequest::Kind::kStop;
  };
  while (!stopped() && std::chrono::steady_clock::now() - began < std::chrono::seconds(10)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_TRUE(stopped());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  EXPECT_LT(took.count(), 1.0) << "one by one, as a page sends them, they would take 6 s";
  EXPECT_EQ(feed.hands().size(), 2000U);
}

TEST_F(ServerTest, AFloodEndsTheConnection) {
  RawClient client(server.port());
  client.open_web_socket(own("Origin: http://"));
  for (int k = 0; k < 12000; ++k) client.send_frame(1, R"({"request":"pause"})");
  const auto close = client.read_frame(8);
  ASSERT_TRUE(close);
  EXPECT_EQ(close->close_code(), 1008);
  EXPECT_GE(feed.requests().size(), 4000U) << "a link that stalled for a while may bring so many";
  EXPECT_LT(feed.requests().size(), 12000U);
}

TEST_F(ServerTest, OtherMessagesEndTheConnection) {
  const auto close_code_after = [this](int opcode, std::string_view payload) {
    RawClient client(server.port());
    EXPECT_EQ(client.open_web_socket().status, 101);
    EXPECT_TRUE(client.read_frame(2));
    client.send_frame(opcode, payload);
    const auto close = client.read_frame(8);
    return close ? close->close_code() : 0;
  };
  EXPECT_EQ(close_code_after(1, R"({"request":"format"})"), 1008);
  EXPECT_EQ(close_code_after(2, R"({"request":"pause"})"), 1008);
  EXPECT_EQ(close_code_after(1, std::string(5000, ' ')), 1009);
  EXPECT_TRUE(feed.requests().empty());
}

TEST_F(ServerTest, SlowClientDelaysNobodyAndMissesOldFrames) {
  RawClient slow(server.port(), /*receive_buffer=*/16 * 1024);
  ASSERT_EQ(slow.open_web_socket().status, 101);
  RawClient quick(server.port());
  ASSERT_EQ(quick.open_web_socket().status, 101);
  const auto time_of = [](const WebSocketFrame& frame) {
    double time = 0;
    frame.payload.copy(std::bit_cast<char*>(&time), sizeof time, 16);
    return time;
  };
  // `slow` reads nothing meanwhile.
  double newest = 0;
  for (int i = 0; i < 200; ++i) {
    const auto frame = quick.read_frame(2);
    ASSERT_TRUE(frame);
    newest = time_of(*frame);
  }
  EXPECT_GE(newest, 200 * 0.016 - 1e-9);
  int stale = 0;
  for (auto frame = slow.read_frame(2); frame && time_of(*frame) < newest;
       frame = slow.read_frame(2)) {
    ++stale;
  }
  EXPECT_GT(stale, 0);
  EXPECT_LT(stale, 100);
}

TEST(Server, PortInUseIsOneClearLine) {
  SyntheticFeed feed;
  const Server first(feed, {.port = 0}, kPage);
  try {
    const Server second(feed, {.port = first.port()}, kPage);
    FAIL() << "two servers on one port";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                StartsWith("--port " + std::to_string(first.port()) + ": already in use; "));
  }
}

TEST(Server, AddressesThatAreNone) {
  SyntheticFeed feed;
  EXPECT_THROW(Server(feed, {.address = "here", .port = 0}, kPage), InputError);
  EXPECT_THROW(Server(feed, {.address = "203.0.113.1", .port = 0}, kPage), InputError);
}

TEST(Server, EndsWhileClientsAreConnected) {
  SyntheticFeed feed;
  auto server = std::make_unique<Server>(feed, ServerOptions{.port = 0}, kPage);
  RawClient watching(server->port());
  ASSERT_EQ(watching.open_web_socket().status, 101);
  ASSERT_TRUE(watching.read_frame(2));
  RawClient silent(server->port());
  const auto start = Clock::now();
  server.reset();
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(2));
  EXPECT_TRUE(watching.is_closed());
}

}  // namespace
}  // namespace softfinger
