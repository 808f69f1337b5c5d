#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "softfinger/actuation/maestro_protocol.hpp"

namespace softfinger {

/// A hobby servo as simulated: a critically damped second-order position loop with a largest speed,
/// all in pulse width.
struct EmulatedServo {
  int channel = 0;
  double initial_pulse = 1.5e-3;    ///< s; where it stands before the first command
  double pulse_rate = 4e-3;         ///< s of pulse width per s; its largest speed
  double natural_frequency = 60.0;  ///< rad/s of the position loop
};

/// A Maestro controller with its servos. Reads the bytes of a real one, answers them, and moves
/// simulated servos at a fixed 1 kHz. It knows no clock: its owner tells it the time, so the same
/// bytes at the same times give the same positions, bit for bit.
///
/// One thread calls receive(), take_replies() and advance_to(); any thread may ask the rest.
class MaestroEmulator {
 public:
  static constexpr double kStep = 1e-3;  ///< s

  explicit MaestroEmulator(std::span<const EmulatedServo> servos);

  /// Bytes from the line. Allocates nothing.
  void receive(std::span<const std::uint8_t> bytes);
  /// Moves the answers given since the last call to `out`; returns how many bytes. Answers that do
  /// not fit wait for the next call.
  std::size_t take_replies(std::span<std::uint8_t> out);
  /// Moves the servos up to `time` (s from the start). An earlier time does nothing.
  void advance_to(double time);

  /// Where the servo of a channel stands, as the pulse width (s) it would rest at.
  [[nodiscard]] double servo_pulse(int channel) const {
    return at(channel).position.load(std::memory_order_relaxed);
  }
  /// Last target of a channel in quarter microseconds; 0: no pulses.
  [[nodiscard]] std::uint16_t target(int channel) const {
    return at(channel).target.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t malformed_bytes() const {
    return malformed_.load(std::memory_order_relaxed);
  }
  /// Targets set, one per channel and command.
  [[nodiscard]] std::uint64_t targets_set() const {
    return targets_set_.load(std::memory_order_relaxed);
  }

 private:
  struct Channel {
    std::atomic<std::uint16_t> target{0};
    std::atomic<double> position{0.0};  ///< s, servo
    double pulse = 0.0;                 ///< quarter microseconds, what the controller puts out now
    double pulse_speed = 0.0;           ///< quarter microseconds per s
    double speed_limit = 0.0;           ///< quarter microseconds per s; 0: none
    double acceleration_limit = 0.0;    ///< quarter microseconds per s^2; 0: none
    double velocity = 0.0;              ///< servo, s per s
    std::uint16_t home = 0;             ///< quarter microseconds; 0: off
    EmulatedServo servo;
    bool has_servo = false;
  };

  const Channel& at(int channel) const { return channels_[static_cast<std::size_t>(channel)]; }
  void execute(const MaestroRequest& request);
  void set_target(Channel& channel, std::uint16_t target);
  void reply(std::uint16_t value, int bytes);
  static void ramp(Channel& channel);
  static void move_servo(Channel& channel);

  std::array<Channel, kMaestroChannels> channels_;
  MaestroDecoder decoder_;
  std::uint16_t errors_ = 0;
  std::int64_t steps_ = 0;
  std::array<std::uint8_t, 256> replies_{};
  std::size_t reply_size_ = 0;
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<std::uint64_t> malformed_{0};
  std::atomic<std::uint64_t> targets_set_{0};
};

}  // namespace softfinger
