#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "softfinger/motors/emulation/bus_emulator.hpp"

namespace softfinger {

/// What lies between a port and a board, and may hold back what is sent: it waits, and comes all at
/// once when it is let go.
class HoldingLine final : public BusEmulator {
 public:
  /// `board` must outlive this.
  explicit HoldingLine(BusEmulator& board) : board_(board) {}

  void receive(std::span<const std::uint8_t> bytes) override;
  std::size_t take_replies(std::span<std::uint8_t> out) override {
    return board_.take_replies(out);
  }
  void advance_to(double time) override;
  [[nodiscard]] double setpoint(std::size_t servo) const override { return board_.setpoint(servo); }

  /// Any thread.
  void hold(bool yes) { holding_ = yes; }
  /// The most bytes that waited at once. Any thread.
  [[nodiscard]] std::size_t most_waiting() const { return most_waiting_; }

 private:
  BusEmulator& board_;
  std::atomic<bool> holding_{false};
  std::vector<std::uint8_t> waiting_;
  std::atomic<std::size_t> most_waiting_{0};
};

}  // namespace softfinger
