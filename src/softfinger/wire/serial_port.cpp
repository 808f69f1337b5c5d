#include "softfinger/wire/serial_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>
// After <utility>, which its headers need and do not include.
#include <boost/asio/io_context.hpp>
#include <boost/asio/serial_port.hpp>

namespace softfinger {

struct SerialPort::Line {
  boost::asio::io_context context;
  boost::asio::serial_port port{context};
};

namespace {

/// By its major number, see Documentation/admin-guide/devices.txt of Linux.
bool is_pseudo_terminal(int handle) {
  struct stat status {};
  if (::fstat(handle, &status) != 0) return false;
  const unsigned major_number = major(status.st_rdev);
  return major_number >= 136 && major_number <= 143;
}

}  // namespace

SerialPort::SerialPort() : line_(std::make_unique<Line>()) {}
SerialPort::~SerialPort() = default;

std::string SerialPort::open(const std::string& port, unsigned baud) {
  using Options = boost::asio::serial_port_base;
  close();
  boost::system::error_code error;
  const auto refuse = [&](std::string_view reason) {
    close();
    return std::string(reason);
  };
  line_->port.open(port, error);
  if (error) {
    switch (error.value()) {
      case ENOENT:
      case ENXIO:
      case ENODEV:
        return refuse("there is no such port");
      case EACCES:
      case EPERM:
        return refuse("no permission (is the user in the group dialout?)");
      case EBUSY:
        return refuse("another program uses it");
      default:
        return refuse("it is no serial port that can be opened");
    }
  }
  if (::isatty(line_->port.native_handle()) == 0) return refuse("it is no serial port");
  struct stat status {};
  if (is_pseudo_terminal(line_->port.native_handle()) && !std::filesystem::is_symlink(port) &&
      ::fstat(line_->port.native_handle(), &status) == 0) {
    Terminal found{port, status.st_ctim.tv_sec, status.st_ctim.tv_nsec};
    if (terminal_.name == port &&
        (terminal_.seconds != found.seconds || terminal_.nanoseconds != found.nanoseconds)) {
      return refuse("there is no such port");
    }
    terminal_ = std::move(found);
  }
  // Two that move one device would move it against each other.
  if (::flock(line_->port.native_handle(), LOCK_EX | LOCK_NB) != 0) {
    return refuse("another program uses it");
  }
  // Nor one that asks for no lock; an emulator's terminal has its own far end open besides.
  if (!is_pseudo_terminal(line_->port.native_handle())) {
    ::ioctl(line_->port.native_handle(), TIOCEXCL);
  }
  line_->port.set_option(Options::character_size(8), error);
  if (!error) line_->port.set_option(Options::parity(Options::parity::none), error);
  if (!error) line_->port.set_option(Options::stop_bits(Options::stop_bits::one), error);
  if (!error) line_->port.set_option(Options::flow_control(Options::flow_control::none), error);
  if (error) return refuse("it does not take 8 data bits, no parity, one stop bit");
  line_->port.set_option(Options::baud_rate(baud), error);
  if (error) return refuse("it does not take this baud rate");
  // Asio's blocking calls would wait for a slow line; plain non-blocking ones never do.
  const int handle = line_->port.native_handle();
  const int flags = ::fcntl(handle, F_GETFL);
  if (flags < 0 || ::fcntl(handle, F_SETFL, flags | O_NONBLOCK) < 0) {
    return refuse("it is no serial port that can be opened");
  }
  return {};
}

void SerialPort::close() noexcept {
  boost::system::error_code error;
  if (line_->port.is_open()) {
    // A line that is stuck would make close() wait for it to take what it has.
    if (waiting_from_ < waiting_to_) ::tcflush(line_->port.native_handle(), TCIOFLUSH);
    line_->port.close(error);
  }
  waiting_from_ = 0;
  waiting_to_ = 0;
}

bool SerialPort::is_open() const noexcept { return line_->port.is_open(); }

bool SerialPort::flush() noexcept {
  while (waiting_from_ < waiting_to_) {
    const ssize_t put = ::write(line_->port.native_handle(), waiting_.data() + waiting_from_,
                                waiting_to_ - waiting_from_);
    if (put > 0) {
      waiting_from_ += static_cast<std::size_t>(put);
    } else if (put < 0 && errno == EINTR) {
      continue;
    } else {
      return put == 0 || errno == EAGAIN || errno == EWOULDBLOCK;
    }
  }
  return true;
}

SerialPort::Result SerialPort::write(std::span<const std::uint8_t> bytes) noexcept {
  if (!is_open()) return Result::kGone;
  const auto send = [this] {
    if (flush()) return true;
    close();
    return false;
  };
  if (!send()) return Result::kGone;
  if (waiting_from_ < waiting_to_ || bytes.size() > kMaxWrite) return Result::kBusy;
  std::copy(bytes.begin(), bytes.end(), waiting_.begin());
  waiting_from_ = 0;
  waiting_to_ = bytes.size();
  return send() ? Result::kSent : Result::kGone;
}

std::size_t SerialPort::read(std::span<std::uint8_t> out) noexcept {
  if (!is_open()) return 0;
  // Asked first, since a read that finds nothing waits for the kernel's own thread to look, which
  // on a busy machine may take a quarter of a second.
  int bytes = 0;
  if (::ioctl(line_->port.native_handle(), FIONREAD, &bytes) == 0 && bytes == 0) return 0;
  const ssize_t got = ::read(line_->port.native_handle(), out.data(), out.size());
  if (got > 0) return static_cast<std::size_t>(got);
  // A raw tty without data says EAGAIN; end of file or an I/O error is a line that hung up.
  if (got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) close();
  return 0;
}

void SerialPort::await_kernel() noexcept {
  if (!is_open()) return;
  pollfd input{.fd = line_->port.native_handle(), .events = POLLIN, .revents = 0};
  ::poll(&input, 1, 0);
}

void SerialPort::drain() noexcept {
  std::array<std::uint8_t, 64> noise;
  while (read(noise) == noise.size()) {
  }
}

void SerialPort::discard_input() noexcept {
  if (is_open()) ::tcflush(line_->port.native_handle(), TCIFLUSH);
}

}  // namespace softfinger
