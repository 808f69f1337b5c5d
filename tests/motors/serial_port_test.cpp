#include "softfinger/wire/serial_port.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <functional>
#include <thread>
#include <vector>

#include "../support/maestro_terminal.hpp"

namespace softfinger {
namespace {

const std::array<EmulatedServo, 1> kServo{EmulatedServo{.channel = 0}};

/// Waits up to 5 s for something that another thread brings about.
bool before_long(const std::function<bool()>& done) {
  for (int i = 0; i < 1000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

TEST(SerialPort, CarriesEveryByteValueToAPseudoTerminal) {
  MaestroTerminal terminal(kServo);
  SerialPort port;
  ASSERT_EQ(port.open(terminal.port(), 115200), "");
  // Control characters must pass as they are: targets with 0x03, 0x0A, 0x0D, 0x11, 0x13, 0x1A.
  std::uint64_t sent = 0;
  for (std::uint16_t target = 1; target < 16384; target = static_cast<std::uint16_t>(target + 97)) {
    ASSERT_TRUE(before_long(
        [&] { return port.write(encode_set_target(0, target)) == SerialPort::Result::kSent; }));
    sent += 4;
    ASSERT_TRUE(before_long([&] { return terminal.emulator().target(0) == target; }));
  }
  EXPECT_EQ(terminal.emulator().bytes(), sent);
  EXPECT_EQ(terminal.emulator().malformed_bytes(), 0u);
}

TEST(SerialPort, BringsAnswersBack) {
  MaestroTerminal terminal(kServo);
  SerialPort port;
  ASSERT_EQ(port.open(terminal.port(), 115200), "");
  ASSERT_EQ(port.write(encode_get_position(0)), SerialPort::Result::kSent);
  std::array<std::uint8_t, 8> answer{};
  std::size_t size = 0;
  ASSERT_TRUE(before_long([&] {
    size += port.read(std::span(answer).subspan(size));
    return size == 2;
  }));
  EXPECT_EQ(decode_reply(answer[0], answer[1]), 6000);
}

TEST(SerialPort, NoticesThatTheOtherEndVanished) {
  for (const bool by_writing : {true, false}) {
    MaestroTerminal terminal(kServo);
    SerialPort port;
    ASSERT_EQ(port.open(terminal.port(), 115200), "");
    std::array<std::uint8_t, 8> answer{};
    EXPECT_EQ(port.read(answer), 0u);
    EXPECT_TRUE(port.is_open());
    terminal.vanish();
    if (by_writing) {
      EXPECT_EQ(port.write(encode_set_target(0, 6000)), SerialPort::Result::kGone);
    } else {
      EXPECT_EQ(port.read(answer), 0u);
    }
    EXPECT_FALSE(port.is_open());
    EXPECT_EQ(port.write(encode_set_target(0, 6000)), SerialPort::Result::kGone);
  }
}

TEST(SerialPort, AFullLineNeverBlocksAndNeverCutsACommand) {
  // A pseudo-terminal that nobody reads.
  const int near = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(near, 0);
  ASSERT_EQ(::grantpt(near), 0);
  ASSERT_EQ(::unlockpt(near), 0);
  std::array<char, 64> name{};
  ASSERT_EQ(::ptsname_r(near, name.data(), name.size()), 0);
  SerialPort port;
  ASSERT_EQ(port.open(name.data(), 115200), "");
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
  std::array<std::uint8_t, 4096> chunk{};
  ASSERT_TRUE(before_long([&] {
    const auto got = ::read(near, chunk.data(), chunk.size());
    if (got > 0) arrived.insert(arrived.end(), chunk.begin(), chunk.begin() + got);
    (void)port.write({});
    return arrived.size() >= taken * bytes.size();
  }));
  ASSERT_EQ(arrived.size(), taken * bytes.size());
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    ASSERT_EQ(arrived[i], bytes[i % bytes.size()]) << i;
  }
  ::close(near);
}

TEST(SerialPort, SaysWhyAPortCannotBeOpened) {
  SerialPort port;
  EXPECT_EQ(port.open("/dev/no-such-port", 115200), "there is no such port");
  EXPECT_EQ(port.open("/dev/null", 115200), "it is no serial port that can be opened");
  EXPECT_FALSE(port.is_open());
  MaestroTerminal terminal(kServo);
  EXPECT_EQ(port.open(terminal.port(), 12345), "it does not take this baud rate");
  EXPECT_FALSE(port.is_open());
}

}  // namespace
}  // namespace softfinger
