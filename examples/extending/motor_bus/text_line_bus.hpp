#pragma once

#include <array>
#include <string>
#include <vector>

#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/wire/serial_port.hpp"

namespace softfinger {

/// A microcontroller on a serial port that reads lines: "m 1500 1480 1520" moves its servos to
/// these pulse widths, in microseconds; to "?" it answers "p 1500 1480 1520".
class TextLineBus : public ServoBus {
 public:
  explicit TextLineBus(const TransportSettings& transport);

  [[nodiscard]] std::string open(const std::string& port) override;
  void close() noexcept override { port_.close(); }
  [[nodiscard]] bool is_open() const noexcept override { return port_.is_open(); }
  bool write(std::span<const std::int32_t> targets) noexcept override;
  bool ask() noexcept override;
  bool take_positions(std::span<std::int32_t> positions) noexcept override;
  void drain() noexcept override { port_.drain(); }

 private:
  unsigned baud_;
  std::size_t servos_;
  SerialPort port_;
  std::array<char, 256> answer_{};  ///< as far as it has come
  std::size_t answered_ = 0;
};

/// Reads "LETTER N N .. N" (one line without its end) into `numbers`, all of them 0 to 65535; false
/// where it says anything else.
[[nodiscard]] bool read_text_line(std::string_view line, char letter,
                                  std::span<std::int32_t> numbers);

}  // namespace softfinger
