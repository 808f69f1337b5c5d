#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace softfinger {

/// The far end of a servo bus: reads the bytes that a real one would, answers them, and moves
/// simulated servos. It knows no clock: its owner tells it the time, so the same bytes at the same
/// times give the same positions, bit for bit.
///
/// One thread calls receive(), take_replies() and advance_to(); any thread may ask the rest.
class BusEmulator {
 public:
  BusEmulator() = default;
  virtual ~BusEmulator() = default;
  BusEmulator(const BusEmulator&) = delete;
  BusEmulator& operator=(const BusEmulator&) = delete;

  /// Bytes from the line, or one datagram.
  virtual void receive(std::span<const std::uint8_t> bytes) = 0;
  /// Moves the answers given since the last call to `out`; returns how many bytes. Answers that do
  /// not fit wait for the next call.
  virtual std::size_t take_replies(std::span<std::uint8_t> out) = 0;
  /// Moves the servos up to `time` (s from the start). An earlier time does nothing.
  virtual void advance_to(double time) = 0;
  /// Where a servo stands, counted as at construction, as a set point of the transport.
  [[nodiscard]] virtual double setpoint(std::size_t servo) const = 0;
};

/// Answers on their way out, first in, first out; what does not fit is lost.
class ReplyBuffer {
 public:
  /// Takes all or nothing; false: no room.
  bool add(std::span<const std::uint8_t> bytes);
  std::size_t take(std::span<std::uint8_t> out);

 private:
  std::array<std::uint8_t, 2048> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace softfinger
