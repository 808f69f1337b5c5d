#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulated_servo.hpp"

namespace softfinger {

/// The board at the far end of a TextLineBus. Lines that it does not know move nothing.
class TextLineEmulator : public BusEmulator {
 public:
  explicit TextLineEmulator(std::span<const EmulatedServo> servos);

  void receive(std::span<const std::uint8_t> bytes) override;
  std::size_t take_replies(std::span<std::uint8_t> out) override { return replies_.take(out); }
  void advance_to(double time) override;
  [[nodiscard]] double setpoint(std::size_t servo) const override {
    return motions_[servo].setpoint();
  }

 private:
  void read_line();
  void answer();

  std::vector<ServoMotion> motions_;
  std::vector<std::int32_t> targets_, read_;
  std::string line_;
  ReplyBuffer replies_;
  ServoClock clock_;
};

}  // namespace softfinger
