#include "softfinger/motors/emulation/emulator_terminal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

/// How long the thread sleeps when no byte comes: two servo steps.
constexpr int kIdle_ms = 2;

}  // namespace

EmulatorTerminal::EmulatorTerminal(BusEmulator& emulator) : emulator_(emulator) {
  near_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 64> name{};
  if (near_ >= 0 && ::grantpt(near_) == 0 && ::unlockpt(near_) == 0 &&
      ::ptsname_r(near_, name.data(), name.size()) == 0) {
    port_ = name.data();
    far_ = ::open(port_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  }
  termios attributes{};
  if (far_ < 0 || ::tcgetattr(far_, &attributes) != 0) {
    const int error = errno;
    if (near_ >= 0) ::close(near_);
    if (far_ >= 0) ::close(far_);
    throw OperationError(fmt::format("no pseudo-terminal for the emulator: {}",
                                     std::system_category().message(error)));
  }
  ::cfmakeraw(&attributes);
  ::tcsetattr(far_, TCSANOW, &attributes);
  thread_ = std::thread([this] { serve(); });
}

EmulatorTerminal::~EmulatorTerminal() {
  vanish();
  ::close(far_);
}

void EmulatorTerminal::vanish() {
  if (!thread_.joinable()) return;
  stop_ = true;
  thread_.join();
  // Its number stays taken as long as the far end is open: who goes on trying to open the port must
  // not find another program's there.
  ::close(near_);
}

void EmulatorTerminal::serve() {
  const auto start = std::chrono::steady_clock::now();
  std::array<std::uint8_t, 512> buffer;
  while (!stop_.load(std::memory_order_relaxed)) {
    pollfd line{.fd = near_, .events = POLLIN, .revents = 0};
    ::poll(&line, 1, kIdle_ms);
    emulator_.advance_to(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if ((line.revents & POLLIN) != 0) {
      const ssize_t got = ::read(near_, buffer.data(), buffer.size());
      if (got > 0) emulator_.receive(std::span(buffer).first(static_cast<std::size_t>(got)));
    }
    const std::size_t answer = emulator_.take_replies(buffer);
    std::size_t written = 0;
    while (written < answer) {
      const ssize_t put = ::write(near_, buffer.data() + written, answer - written);
      if (put <= 0) break;  // nobody reads: a serial line loses such bytes too
      written += static_cast<std::size_t>(put);
    }
  }
}

}  // namespace softfinger
