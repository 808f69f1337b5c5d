#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/wire/line_clock.hpp"
#include "softfinger/wire/serial_port.hpp"

namespace softfinger {

/// A Pololu Maestro on a serial port, spoken to in its compact protocol. Targets are quarter
/// microseconds of pulse width. Positions are what the controller puts out; hobby servos themselves
/// say nothing. Speed and acceleration of the pulses are limited in the board as well, from
/// open() on, and anew where its pulses stopped: it was without power.
///
/// With every question goes one for the board's errors (section 4.e), and what it says of the line
/// is a complaint. Where the device file says that commands have checksums, or that the board has a
/// serial timeout, open() tries whether that is so.
class MaestroBus : public ServoBus {
 public:
  /// Throws InputError for a servo on a channel that no Maestro has, and where the line is too slow
  /// for the rate. `clock` outlives the bus.
  explicit MaestroBus(const TransportSettings& transport, LineClock& clock = steady_line_clock());

  /// Waits for the board's answers, a moment, and as long as its serial timeout.
  [[nodiscard]] std::string open(const std::string& port) override;
  void lead_those_left() noexcept override { under_way_ = true; }
  void close() noexcept override { port_.close(); }
  [[nodiscard]] bool answers() const noexcept override { return answers_; }
  /// Of the board, and therefore of all servos alike.
  [[nodiscard]] std::uint8_t complaints(std::size_t) const noexcept override { return complaints_; }
  [[nodiscard]] bool is_open() const noexcept override { return port_.is_open(); }
  bool write(std::span<const std::int32_t> targets) noexcept override;
  bool let_go() noexcept override;
  bool ask() noexcept override;
  bool take_positions(std::span<std::int32_t> positions) noexcept override;
  void drain() noexcept override;

 private:
  /// Bytes that answer question_.
  [[nodiscard]] std::size_t answer_size() const { return 2 * (channels_.size() + 1); }
  /// As it goes over the line.
  void add(std::vector<std::uint8_t>& bytes, std::span<const std::uint8_t> command) const;
  /// Asks, and waits for an answer of so many bytes; empty: none came.
  std::vector<std::uint8_t> exchange(std::span<const std::uint8_t> question, std::size_t size,
                                     LineClock::Duration patience);
  /// What the board has noted since it was asked last; empty: it does not answer.
  std::optional<std::uint16_t> errors();
  /// How long the answers to so many questions at once take; at most `patience`.
  LineClock::Duration time_of(std::size_t questions, LineClock::Duration patience);
  // Each returns an empty text, or why the board is not as the device file says.
  [[nodiscard]] std::string check_crc();
  [[nodiscard]] std::string check_timeout();
  [[nodiscard]] std::string check_pace();

  /// What the board says of itself, with an answer.
  void note(std::uint16_t errors) noexcept;

  LineClock& clock_;
  unsigned baud_;
  double period_;            ///< of device ticks, s
  double tick_share_ = 1.0;  ///< bytes of a tick for one of its question and answer
  bool crc_;
  double serial_timeout_;  ///< s; 0: none
  std::vector<int> channels_;
  std::vector<std::uint8_t> error_question_;
  std::vector<std::uint8_t> question_;  ///< of each tick: positions, then errors
  bool under_way_ = false;              ///< see lead_those_left()
  std::uint8_t complaints_ = 0;
  int suspicion_ = 0;                 ///< answers until an error is forgotten
  std::vector<std::uint8_t> limits_;  ///< of speed and acceleration, as they are sent
  bool answers_ = false;              ///< since open()
  bool pulses_ = false;               ///< all channels have them
  bool limits_due_ = false;           ///< the board has forgotten them
  SerialPort port_;
};

}  // namespace softfinger
