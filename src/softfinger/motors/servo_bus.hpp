#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "softfinger/motors/servo_faults.hpp"
#include "softfinger/motors/transport_settings.hpp"
#include "softfinger/wire/line_clock.hpp"

namespace softfinger {

/// What speaks to the servos of one device over one port: targets go out, positions come in. It
/// knows the bytes and nothing of limits, of time or of what a device is.
///
/// Targets and positions are whole steps of the wire (ServoSettings::step), one a servo in the
/// order of the device file. After open() nothing allocates, and nothing but open() waits. One
/// thread at a time.
class ServoBus {
 public:
  ServoBus() = default;
  virtual ~ServoBus() = default;
  ServoBus(const ServoBus&) = delete;
  ServoBus& operator=(const ServoBus&) = delete;

  /// Opens the port and makes the servos ready. Returns an empty text, or in few words why not.
  [[nodiscard]] virtual std::string open(const std::string& port) = 0;
  /// From now on open() makes ready those servos that answer, if any does, and tells of the others
  /// as faults(), instead of refusing: a device under way has to get away from the finger.
  virtual void lead_those_left() noexcept {}
  virtual void close() noexcept = 0;
  [[nodiscard]] virtual bool is_open() const noexcept = 0;

  /// Servos that cannot be led any more, until the port is opened again; the others are. None where
  /// the bus cannot tell.
  [[nodiscard]] virtual ServoFaults faults() const noexcept { return {}; }

  /// Of one servo, bits of ServoComplaint. None where the bus cannot tell.
  [[nodiscard]] virtual std::uint8_t complaints(std::size_t /*servo*/) const noexcept { return 0; }

  /// Sends the targets of all servos, whole or not at all. False: not sent, since earlier bytes
  /// still wait or the port vanished (it is closed then).
  virtual bool write(std::span<const std::int32_t> targets) noexcept = 0;

  /// Takes torque or pulses from the servos, which then hold nothing; false: not sent, or this bus
  /// cannot.
  virtual bool let_go() noexcept { return false; }

  /// Asks the servos where they are, without waiting; false where this bus has no such question.
  virtual bool ask() noexcept = 0;
  /// Whether servos have answered since open(), also that they know no position.
  [[nodiscard]] virtual bool answers() const noexcept { return false; }
  /// Takes the answers to the last ask(), if all have come and every servo knows its position;
  /// those of faults() may be anything.
  virtual bool take_positions(std::span<std::int32_t> positions) noexcept = 0;
  /// Reads and forgets what has come; notices a port that hung up.
  virtual void drain() noexcept = 0;
};

/// The bus for a device file's `[transport]`; `clock` outlives it. Throws InputError for a kind
/// that cannot be driven.
[[nodiscard]] std::unique_ptr<ServoBus> make_servo_bus(const TransportSettings& transport,
                                                       LineClock& clock = steady_line_clock());

}  // namespace softfinger
