#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace softfinger {

/// A serial line: 8 data bits, no parity, one stop bit, raw. Any tty, pseudo-terminals included.
/// After open() nothing allocates, and nothing waits for the line. One thread at a time.
class SerialPort {
 public:
  SerialPort();
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// Opens a tty. Returns an empty text, or in few words why it cannot be opened. A pseudo-terminal
  /// that is gone stays gone: another one under its number is not what was opened before.
  [[nodiscard]] std::string open(const std::string& port, unsigned baud);
  void close() noexcept;
  [[nodiscard]] bool is_open() const noexcept;

  enum class Result {
    kSent,  ///< handed to the line, or kept to go first at the next call
    kBusy,  ///< earlier bytes still wait, these were not taken
    kGone,  ///< the port vanished; it is closed now
  };
  /// Writes all of `bytes` (at most kMaxWrite) or none, so that no command is ever cut in two.
  Result write(std::span<const std::uint8_t> bytes) noexcept;
  static constexpr std::size_t kMaxWrite = 512;
  /// What a byte takes on the line: a start bit, eight of data and a stop bit.
  static constexpr double kBitsPerByte = 10.0;

  /// Takes what has arrived, without waiting; returns how many bytes. Closes a port that vanished.
  /// On a busy machine what the kernel has not looked at yet comes with a later call.
  std::size_t read(std::span<std::uint8_t> out) noexcept;
  /// Has the kernel look at what has arrived, which may take a quarter of a second: for answers
  /// that somebody waits for, and not for the real-time path.
  void await_kernel() noexcept;
  /// Reads and forgets what has arrived; closes a port that vanished.
  void drain() noexcept;
  /// Forgets what has arrived and not been read.
  void discard_input() noexcept;

 private:
  bool flush() noexcept;  ///< false: vanished

  /// Which pseudo-terminal stood under a name.
  struct Terminal {
    std::string name;
    std::int64_t seconds = 0, nanoseconds = 0;  ///< since when
  };

  struct Line;
  std::unique_ptr<Line> line_;
  Terminal terminal_;  ///< the last one opened
  std::array<std::uint8_t, kMaxWrite> waiting_{};
  std::size_t waiting_from_ = 0;
  std::size_t waiting_to_ = 0;
};

}  // namespace softfinger
