#include "softfinger/session/event_sender.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/wire/osc.hpp"

namespace softfinger {
namespace {

/// Takes what is sent to a port of this machine.
class OscListener {
 public:
  OscListener() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~OscListener() { ::close(socket_); }
  OscListener(const OscListener&) = delete;
  OscListener& operator=(const OscListener&) = delete;

  [[nodiscard]] std::string target() const { return "osc:127.0.0.1:" + std::to_string(port_); }

  struct Told {
    std::string address, types;
    std::vector<std::string> texts;
    std::vector<float> numbers;
  };
  /// The next one; of empty address: none came within so many ms.
  Told next(int patience) {
    Told told;
    pollfd event{.fd = socket_, .events = POLLIN, .revents = {}};
    if (::poll(&event, 1, patience) != 1) return told;
    std::array<std::uint8_t, 1024> bytes{};
    const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
    EXPECT_TRUE(read_osc(std::span(bytes).first(static_cast<std::size_t>(got)),
                         [&](const OscMessage& message) {
                           told.address = message.address;
                           told.types = message.types;
                           read(message, told);
                           return true;
                         }));
    return told;
  }

 private:
  /// Texts are padded to words, as OSC 1.0 has them.
  static void read(const OscMessage& message, Told& told) {
    std::size_t at = 0;
    for (const char type : message.types) {
      if (type == 's') {
        const auto* text = reinterpret_cast<const char*>(message.arguments.data() + at);
        told.texts.emplace_back(text);
        at += (told.texts.back().size() / 4 + 1) * 4;
        continue;
      }
      std::uint32_t bits = 0;
      for (int k = 0; k < 4; ++k) bits = bits << 8U | message.arguments[at++];
      told.numbers.push_back(std::bit_cast<float>(bits));
    }
    EXPECT_EQ(at, message.arguments.size());
  }

  int socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  int port_ = 0;
};

TEST(EventSender, SendsKindAndNamesThenTimeAndImpulse) {
  OscListener listener;
  EventSender sender(listener.target(), {"cup", "table", "thumb"});
  sender.send({.time = 1.25, .kind = 0, .object = 0, .other = 2, .impulse = 0.5});
  const OscListener::Told impact = listener.next(2000);
  EXPECT_EQ(impact.address, "/softfinger/event");
  EXPECT_EQ(impact.types, "sssff");
  EXPECT_THAT(impact.texts, testing::ElementsAre("impact", "cup", "thumb"));
  EXPECT_THAT(impact.numbers, testing::ElementsAre(1.25F, 0.5F));
  sender.send({.time = 2.0, .kind = 2, .object = 1});
  const OscListener::Told click = listener.next(2000);
  EXPECT_THAT(click.texts, testing::ElementsAre("click", "table", ""));
  EXPECT_TRUE(std::isnan(click.numbers.at(1)));
}

TEST(EventSender, SaysWhereItCannotSend) {
  for (const char* to : {"127.0.0.1:9000", "udp:127.0.0.1:9000", "osc:127.0.0.1", "osc:127.0.0.1:0",
                         "osc:127.0.0.1:70000", "osc:no such host:9000"}) {
    try {
      EventSender(to, {});
      ADD_FAILURE() << to;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(std::string("--events ") + to + ": "));
    }
  }
}

// A button that a finger presses: it touches, and it snaps.
TEST(EventSender, ARunSendsWhatHappensInIt) {
  OscListener listener;
  RunOptions options;
  options.scene = std::filesystem::path(source_folder()) / "scenes/button.toml";
  options.as_fast_as_possible = true;
  options.duration = 1.6;
  options.events = listener.target();
  std::atomic<bool> stop{false};
  run_headless(options, stop);
  std::vector<std::string> kinds;
  for (auto told = listener.next(0); !told.address.empty(); told = listener.next(0)) {
    EXPECT_EQ(told.texts.at(1), "button");
    kinds.push_back(told.texts.at(0));
  }
  EXPECT_THAT(kinds, testing::IsSupersetOf({"impact", "click"}));
}

}  // namespace
}  // namespace softfinger
