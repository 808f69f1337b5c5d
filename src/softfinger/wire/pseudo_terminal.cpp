#include "softfinger/wire/pseudo_terminal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "softfinger/base/error.hpp"

namespace softfinger {

PseudoTerminal::PseudoTerminal() {
  near_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 64> name{};
  if (near_ >= 0 && ::grantpt(near_) == 0 && ::unlockpt(near_) == 0 &&
      ::ptsname_r(near_, name.data(), name.size()) == 0) {
    name_ = name.data();
    far_ = ::open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
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
}

PseudoTerminal::~PseudoTerminal() {
  vanish();
  ::close(far_);
}

void PseudoTerminal::vanish() {
  // Its number stays taken as long as the far end is open: who goes on trying to open the port must
  // not find another program's there.
  if (near_ >= 0) ::close(near_);
  near_ = -1;
}

void PseudoTerminal::wait(int milliseconds) const {
  pollfd line{.fd = near_, .events = POLLIN, .revents = 0};
  ::poll(&line, 1, milliseconds);
}

std::size_t PseudoTerminal::read(std::span<std::uint8_t> out) {
  const ssize_t got = near_ < 0 ? -1 : ::read(near_, out.data(), out.size());
  return got > 0 ? static_cast<std::size_t>(got) : 0;
}

void PseudoTerminal::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && near_ >= 0) {
    const ssize_t put = ::write(near_, bytes.data(), bytes.size());
    if (put <= 0) return;
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
}

}  // namespace softfinger
