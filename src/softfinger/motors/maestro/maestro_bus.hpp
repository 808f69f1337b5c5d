#pragma once

#include <cstdint>
#include <vector>

#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/wire/serial_port.hpp"

namespace softfinger {

/// A Pololu Maestro on a serial port, spoken to in its compact protocol. Targets are quarter
/// microseconds of pulse width. Positions are what the controller puts out; hobby servos themselves
/// say nothing. Speed and acceleration of the pulses are limited in the board as well, from
/// open() on, and anew where its pulses stopped: it was without power.
class MaestroBus : public ServoBus {
 public:
  /// Throws InputError for a servo on a channel that no Maestro has, and where the line is too slow
  /// for the rate.
  explicit MaestroBus(const TransportSettings& transport);

  [[nodiscard]] std::string open(const std::string& port) override;
  void close() noexcept override { port_.close(); }
  [[nodiscard]] bool answers() const noexcept override { return answers_; }
  [[nodiscard]] bool is_open() const noexcept override { return port_.is_open(); }
  bool write(std::span<const std::int32_t> targets) noexcept override;
  bool let_go() noexcept override;
  bool ask() noexcept override;
  bool take_positions(std::span<std::int32_t> positions) noexcept override;
  void drain() noexcept override { port_.drain(); }

 private:
  unsigned baud_;
  std::vector<int> channels_;
  std::vector<std::uint8_t> limits_;  ///< of speed and acceleration, as they are sent
  bool answers_ = false;              ///< since open()
  bool pulses_ = false;               ///< all channels have them
  bool limits_due_ = false;           ///< the board has forgotten them
  SerialPort port_;
};

}  // namespace softfinger
