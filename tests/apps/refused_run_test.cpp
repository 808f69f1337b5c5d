// What a live run cannot have is refused before the port of any device is opened.

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

/// A file in a terminal's place that knows whether anybody has opened it. Not a pseudo-terminal:
/// what another test's device was lost from goes on looking for its number, and would open the next
/// one that has it.
class WatchedPort {
 public:
  explicit WatchedPort(const Workplace& place)
      : path_(place.path("port")), watch_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    place.write("port", "");
    EXPECT_GE(::inotify_add_watch(watch_, path_.c_str(), IN_OPEN), 0) << path_;
  }
  ~WatchedPort() { ::close(watch_); }
  WatchedPort(const WatchedPort&) = delete;
  WatchedPort& operator=(const WatchedPort&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] bool was_opened() const {
    pollfd look{watch_, POLLIN, 0};
    return ::poll(&look, 1, 0) > 0;
  }

 private:
  std::string path_;
  int watch_;
};

/// A port of this machine that somebody listens at.
class OccupiedPort {
 public:
  OccupiedPort() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(socket_, any, size), 0);
    EXPECT_EQ(::listen(socket_, 1), 0);
    EXPECT_EQ(::getsockname(socket_, any, &size), 0);
    number_ = std::to_string(ntohs(address.sin_port));
  }
  ~OccupiedPort() { ::close(socket_); }
  OccupiedPort(const OccupiedPort&) = delete;
  OccupiedPort& operator=(const OccupiedPort&) = delete;

  [[nodiscard]] const std::string& number() const { return number_; }

 private:
  int socket_;
  std::string number_;
};

class RefusedRun : public testing::Test {
 protected:
  RefusedRun() {
    place.replace_line("devices/thimble-3rrs.toml", "port =", "port = \"" + port.path() + "\"");
  }
  void expect_no_device(std::vector<std::string> flags, const std::vector<std::string>& words) {
    flags.insert(flags.begin(), {"run", place.path("scenes/sphere.toml")});
    expect_refused(run_program(flags), words);
    EXPECT_FALSE(port.was_opened()) << words.front();
  }

  Workplace place;
  const WatchedPort port{place};
};

TEST_F(RefusedRun, OpensNoDevice) {
  const OccupiedPort occupied;
  place.write("page.pem", "no certificate");
  place.write("old.db", "");
  const std::string page = place.path("page.pem");
  expect_no_device({"--port", occupied.number()}, {"--port " + occupied.number(), "in use"});
  expect_no_device({"--listen", "here"}, {"--listen here"});
  expect_no_device({"--listen", "203.0.113.1"}, {"--listen 203.0.113.1", "--token"});
  expect_no_device({"--certificate", "/no/such.pem", "--key", page},
                   {"--certificate /no/such.pem"});
  expect_no_device({"--certificate", page, "--key", page}, {"--certificate " + page});
  expect_no_device({"--certificate", page}, {"--certificate", "--key"});
  expect_no_device({"--port", "0", "--record", place.path("old.db")}, {"exists already"});
  expect_no_device({"--port", "0", "--record", place.path("no/such/run.db")},
                   {"no/such/run.db: cannot be created"});
  expect_no_device({"--headless", "--record", place.path("old.db")}, {"exists already"});
}

// Nor of the first finger where the second one's tracker is refused.
TEST_F(RefusedRun, OpensNoDeviceBeforeEveryTracker) {
  expect_no_device({"--headless", "--tracker", "page"}, {"page"});
  const std::string hand = place.read("scenes/sphere.toml");
  const std::string finger = hand.substr(hand.find("[[finger]]"));
  std::string second = finger.substr(0, finger.find("[[object]]"));
  second.replace(second.find("name = \"index\""), 14, "name = \"other\"");
  place.write("scenes/sphere.toml", hand + second);
  expect_no_device({"--headless", "--tracker", "other=page"}, {"other", "page"});
}

// That the port would tell.
TEST_F(RefusedRun, OpensItsDeviceOtherwise) {
  const ProgramRun run =
      run_program({"run", place.path("scenes/sphere.toml"), "--headless", "--duration-s", "0.1"});
  EXPECT_TRUE(port.was_opened()) << run.errors;
}

}  // namespace
}  // namespace softfinger
