#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulated_servo.hpp"
#include "softfinger/motors/servo_table/frame_reader.hpp"
#include "softfinger/motors/servo_table/servo_protocol.hpp"

namespace softfinger {

/// Servos with control tables, in ticks: Dynamixel X series or Feetech STS, as their protocol says.
/// They read every byte, answer only frames whose checksum is right, refuse what real ones refuse,
/// and move while their torque is on.
class ServoTableEmulator : public BusEmulator {
 public:
  ServoTableEmulator(std::unique_ptr<const ServoProtocol> protocol,
                     std::span<const EmulatedServo> servos);

  void receive(std::span<const std::uint8_t> bytes) override;
  std::size_t take_replies(std::span<std::uint8_t> out) override { return replies_.take(out); }
  void advance_to(double time) override;
  [[nodiscard]] double setpoint(std::size_t servo) const override {
    return servos_[servo].motion.setpoint();
  }

  /// Cuts the power of all servos for a moment, at the next bytes: what is half read is lost,
  /// torque is off. From any thread.
  void reset() { reset_ = true; }
  /// Acknowledges what is written to this register, and does not keep it; before the first bytes.
  void forget(ServoRegister at) { forgotten_ = at; }
  /// Turns a servo by hand, to a set point; before the first bytes.
  void turn(std::size_t servo, double setpoint);
  /// Cuts one servo off the bus, or brings it back: it keeps its torque and its last goal, hears
  /// nothing and says nothing; nor do those after it in an answer to a question to several, which
  /// wait for it. From any thread.
  void cut_off(std::size_t servo, bool off = true) { servos_[servo].cut_off = off; }
  /// One servo protects itself, as from overload: its torque is off. From any thread.
  void trip(std::size_t servo) { servos_[servo].tripped = true; }
  /// What one servo says of itself when asked: bits of its errors, and its temperature, degrees
  /// Celsius. From any thread.
  void complain(std::size_t servo, std::uint8_t errors) { servos_[servo].errors = errors; }
  void heat(std::size_t servo, std::uint8_t temperature) {
    servos_[servo].temperature = temperature;
  }
  /// One servo is stuck where it is, and says so when asked; or is free again. From any thread.
  void block(std::size_t servo, bool on = true) { servos_[servo].blocked = on; }
  [[nodiscard]] std::int32_t goal(std::size_t servo) const { return servos_[servo].goal; }
  /// Whether a servo's watchdog has stopped it, and still does.
  [[nodiscard]] bool has_barked(std::size_t servo) const { return servos_[servo].barked; }
  [[nodiscard]] bool torque(std::size_t servo) const { return servos_[servo].torque; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Bytes that were part of no valid frame.
  [[nodiscard]] std::uint64_t malformed_bytes() const { return malformed_; }
  /// Least and largest goal ever written.
  [[nodiscard]] std::int32_t least_goal() const { return least_goal_; }
  [[nodiscard]] std::int32_t largest_goal() const { return largest_goal_; }
  [[nodiscard]] const ControlTable& table() const { return protocol_->table(); }
  /// A register as it is; of a bus that is still.
  [[nodiscard]] std::uint32_t value(std::size_t servo, ServoRegister at) const {
    return get(servos_[servo], at);
  }
  /// Writes to registers that are kept without power.
  [[nodiscard]] std::uint64_t lasting_writes() const { return lasting_writes_; }
  /// Sync writes of goals.
  [[nodiscard]] std::uint64_t commands() const { return commands_; }

 private:
  struct Servo {
    std::array<std::uint8_t, 256> memory{};
    ServoMotion motion;
    std::uint8_t id = 0;
    std::atomic<std::int32_t> goal{0};
    std::atomic<bool> torque{false};
    std::atomic<bool> cut_off{false};
    std::atomic<bool> tripped{false};
    std::atomic<bool> blocked{false};
    std::atomic<std::uint8_t> errors{0};
    std::atomic<std::uint8_t> temperature{35};
    std::atomic<bool> barked{false};  ///< its watchdog
    int unheard = 0;                  ///< ms since the last instruction
  };

  void execute(const ServoFrame& frame);
  void answer(std::uint8_t id, std::uint8_t error, std::span<const std::uint8_t> data);
  void answer_read(Servo& servo, std::size_t address, std::size_t length);
  /// Error of the status; 0: done.
  std::uint8_t write(Servo& servo, std::size_t address, std::span<const std::uint8_t> bytes);
  void put(Servo& servo, ServoRegister at, std::uint32_t value);
  [[nodiscard]] std::uint32_t get(const Servo& servo, ServoRegister at) const;
  void note_position(Servo& servo);
  /// 1 ms without an instruction.
  void hear_nothing(Servo& servo);
  void lose_power();

  std::unique_ptr<const ServoProtocol> protocol_;
  std::vector<Servo> servos_;
  FrameReader reader_;
  ReplyBuffer replies_;
  ServoClock clock_;
  bool dynamixel_;
  ServoRegister forgotten_;  ///< of size 0: none
  std::atomic<bool> reset_{false};
  std::atomic<std::uint64_t> frames_{0}, malformed_{0}, commands_{0}, lasting_writes_{0};
  std::atomic<std::int32_t> least_goal_, largest_goal_;
};

}  // namespace softfinger
