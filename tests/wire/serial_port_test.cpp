#include "softfinger/wire/serial_port.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

namespace softfinger {
namespace {

/// The near end of a pseudo-terminal, read and written without waiting.
class Terminal {
 public:
  Terminal() : near_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    std::array<char, 64> name{};
    EXPECT_EQ(::grantpt(near_), 0);
    EXPECT_EQ(::unlockpt(near_), 0);
    EXPECT_EQ(::ptsname_r(near_, name.data(), name.size()), 0);
    port_ = name.data();
  }
  ~Terminal() { vanish(); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  [[nodiscard]] const std::string& port() const { return port_; }
  /// Adds what has come to `bytes`.
  void read(std::vector<std::uint8_t>& bytes) const {
    std::array<std::uint8_t, 4096> chunk{};
    const auto got = ::read(near_, chunk.data(), chunk.size());
    if (got > 0) bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + got);
  }
  void write(std::span<const std::uint8_t> bytes) const {
    EXPECT_EQ(::write(near_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  void vanish() {
    if (near_ >= 0) ::close(near_);
    near_ = -1;
  }

 private:
  int near_;
  std::string port_;
};

/// Waits up to 5 s for something that another thread or the system brings about.
bool before_long(const std::function<bool()>& done) {
  for (int i = 0; i < 1000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

/// Every byte once, control characters (3, 10, 13, 17, 19, 26, ...) among them.
std::vector<std::uint8_t> every_byte() {
  std::vector<std::uint8_t> bytes(256);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

TEST(SerialPort, CarriesEveryByteValueThereAndBack) {
  const Terminal terminal;
  SerialPort port;
  ASSERT_EQ(port.open(terminal.port(), 115200), "");
  const std::vector<std::uint8_t> sent = every_byte();
  ASSERT_EQ(port.write(sent), SerialPort::Result::kSent);
  std::vector<std::uint8_t> arrived;
  EXPECT_TRUE(before_long([&] {
    terminal.read(arrived);
    return arrived.size() >= sent.size();
  }));
  EXPECT_EQ(arrived, sent);

  terminal.write(sent);
  std::vector<std::uint8_t> answer(2 * sent.size());
  std::size_t size = 0;
  EXPECT_TRUE(before_long([&] {
    size += port.read(std::span(answer).subspan(size));
    return size >= sent.size();
  }));
  answer.resize(size);
  EXPECT_EQ(answer, sent);
  arrived.clear();
  terminal.read(arrived);
  EXPECT_TRUE(arrived.empty()) << "the port echoes";
}

TEST(SerialPort, NoticesThatTheOtherEndVanished) {
  for (const bool by_writing : {true, false}) {
    Terminal terminal;
    SerialPort port;
    ASSERT_EQ(port.open(terminal.port(), 115200), "");
    std::array<std::uint8_t, 8> bytes{};
    EXPECT_EQ(port.read(bytes), 0u);
    EXPECT_TRUE(port.is_open());
    terminal.vanish();
    if (by_writing) {
      EXPECT_EQ(port.write(bytes), SerialPort::Result::kGone);
    } else {
      EXPECT_EQ(port.read(bytes), 0u);
    }
    EXPECT_FALSE(port.is_open());
    EXPECT_EQ(port.write(bytes), SerialPort::Result::kGone);
  }
}

TEST(SerialPort, AFullLineNeverBlocksAndNeverCutsACommand) {
  const Terminal terminal;  // that nobody reads
  SerialPort port;
  ASSERT_EQ(port.open(terminal.port(), 115200), "");
  std::array<std::uint8_t, 300> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i % 100);
  const auto start = std::chrono::steady_clock::now();
  std::size_t taken = 0;
  while (port.write(bytes) == SerialPort::Result::kSent && taken < 10000) ++taken;
  EXPECT_LT(taken, 10000u);
  EXPECT_EQ(port.write(bytes), SerialPort::Result::kBusy);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));

  // All that was taken arrives whole once somebody reads.
  std::vector<std::uint8_t> arrived;
  ASSERT_TRUE(before_long([&] {
    terminal.read(arrived);
    (void)port.write({});
    return arrived.size() >= taken * bytes.size();
  }));
  ASSERT_EQ(arrived.size(), taken * bytes.size());
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    ASSERT_EQ(arrived[i], bytes[i % bytes.size()]) << i;
  }
}

TEST(SerialPort, ATerminalUnderTheNumberOfOneThatIsGoneIsAnotherPort) {
  SerialPort port;
  // Numbers are free again at once, but other programs take some too.
  for (int attempt = 0; attempt < 20; ++attempt) {
    auto terminal = std::make_unique<Terminal>();
    const std::string name = terminal->port();
    ASSERT_EQ(port.open(name, 115200), "");
    port.close();
    ASSERT_EQ(port.open(name, 115200), "") << "the same once more";
    port.close();
    terminal = nullptr;
    // The clock that tells them apart has steps of some milliseconds.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const Terminal next;
    if (next.port() != name) continue;
    EXPECT_EQ(port.open(name, 115200), "there is no such port");
    SerialPort other;
    EXPECT_EQ(other.open(name, 115200), "");
    return;
  }
  FAIL() << "no number came back";
}

TEST(SerialPort, SaysWhyAPortCannotBeOpened) {
  SerialPort port;
  EXPECT_EQ(port.open("/dev/no-such-port", 115200), "there is no such port");
  EXPECT_EQ(port.open("/dev/null", 115200), "it is no serial port that can be opened");
  EXPECT_FALSE(port.is_open());
  const Terminal terminal;
  EXPECT_EQ(port.open(terminal.port(), 12345), "it does not take this baud rate");
  EXPECT_FALSE(port.is_open());
}

}  // namespace
}  // namespace softfinger
