#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulated_servo.hpp"
#include "softfinger/motors/maestro/maestro_protocol.hpp"
#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// What is set in the board itself (Pololu's Maestro Control Center), and not over the line.
struct MaestroBoard {
  enum class OnError { kIgnore, kOff, kGoTo };  ///< where all servos go: on, limp, where they began

  bool crc = false;             ///< commands end in a checksum
  double serial_timeout = 0.0;  ///< s without a command that are an error; 0: none are
  OnError on_error = OnError::kIgnore;
};

/// As a device file says it is set; at an error it takes its servos back to where they began.
[[nodiscard]] MaestroBoard maestro_board(const TransportSettings& transport);

/// A Maestro controller with its servos. Reads the bytes of a real one, answers them, and moves
/// simulated servos at a fixed 1 kHz.
class MaestroEmulator : public BusEmulator {
 public:
  explicit MaestroEmulator(std::span<const EmulatedServo> servos, const MaestroBoard& board = {});

  void receive(std::span<const std::uint8_t> bytes) override;
  std::size_t take_replies(std::span<std::uint8_t> out) override { return replies_.take(out); }
  void advance_to(double time) override;
  [[nodiscard]] double setpoint(std::size_t servo) const override {
    return servo_pulse(servo_channels_[servo]);
  }

  /// Cuts its power for a moment, before the next bytes: pulses stop, half a command is forgotten.
  /// Any thread.
  void reset() { reset_ = true; }
  /// Where the servo of a channel stands, as the pulse width (s) it would rest at.
  [[nodiscard]] double servo_pulse(int channel) const { return at(channel).motion.setpoint(); }
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
    ServoMotion motion;               ///< servo
    double pulse = 0.0;               ///< quarter microseconds, what the controller puts out now
    double pulse_speed = 0.0;         ///< quarter microseconds per s
    double speed_limit = 0.0;         ///< quarter microseconds per s; 0: none
    double acceleration_limit = 0.0;  ///< quarter microseconds per s^2; 0: none
    std::uint16_t home = 0;           ///< quarter microseconds; 0: off
    bool has_servo = false;
  };

  const Channel& at(int channel) const { return channels_[static_cast<std::size_t>(channel)]; }
  void execute(const MaestroRequest& request);
  void lose_power();
  void note_error(MaestroError error);
  void note_silence();
  void set_target(Channel& channel, std::uint16_t target);
  void reply(std::uint16_t value, int bytes);
  static void ramp(Channel& channel);

  MaestroBoard board_;
  std::array<Channel, kMaestroChannels> channels_;
  std::vector<int> servo_channels_;
  MaestroDecoder decoder_;
  std::uint16_t errors_ = 0;
  double now_ = 0.0;        ///< s
  double spoken_to_ = 0.0;  ///< when the last command came, s
  bool timed_out_ = false;  ///< since then
  ServoClock clock_;
  ReplyBuffer replies_;
  std::atomic<bool> reset_{false};
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<std::uint64_t> malformed_{0};
  std::atomic<std::uint64_t> targets_set_{0};
};

}  // namespace softfinger
