#pragma once

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include "holding_line.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/motors/maestro/maestro_emulator.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {

/// An emulated Maestro that may lose its power in the middle of a command, and whose line may cut
/// what it carries.
class TroubledMaestro final : public BusEmulator {
 public:
  explicit TroubledMaestro(std::span<const EmulatedServo> servos)
      : servos_(servos.begin(), servos.end()), maestro_(servos), changes_(servos.size()) {}

  void receive(std::span<const std::uint8_t> bytes) override;
  std::size_t take_replies(std::span<std::uint8_t> out) override;
  void advance_to(double time) override {
    maestro_.advance_to(time);
    std::ranges::fill(changes_, 0);
  }
  [[nodiscard]] double setpoint(std::size_t servo) const override {
    return maestro_.setpoint(servo);
  }

  /// In the middle of the bytes that come next. Any thread.
  void reset() { reset_ = true; }
  /// Whether three packets in ten are cut in half, both ways, but no two in a row. Any thread.
  void cut(bool yes) { cutting_ = yes; }
  /// How often the target of a servo changed at most in what came at one time. Any thread.
  [[nodiscard]] int most_at_once() const { return most_at_once_; }

 private:
  bool cuts();
  void take(std::span<const std::uint8_t> bytes);

  std::vector<EmulatedServo> servos_;
  MaestroEmulator maestro_;
  std::atomic<bool> reset_{false};
  std::atomic<bool> cutting_{false};
  bool cut_before_ = false;
  std::mt19937_64 random_{7};
  std::vector<int> changes_;  ///< of each servo's target since time went on
  std::atomic<int> most_at_once_{0};
};

/// Such a board, or servos on a bus, at the end of a cable that may be pulled or hold bytes back,
/// under a name that stays.
class TroubledBoard {
 public:
  /// Servos at the device's home; what drives them is of the kind of its transport. `name`: of the
  /// port.
  TroubledBoard(std::shared_ptr<const Device> device, std::filesystem::path name);
  ~TroubledBoard();
  TroubledBoard(const TroubledBoard&) = delete;
  TroubledBoard& operator=(const TroubledBoard&) = delete;

  [[nodiscard]] std::string port() const { return name_.string(); }
  void pull();
  /// A pulled cable is back; the board has kept its power and its servos their place.
  void plug_in();
  /// Throws std::bad_cast where it is no Maestro.
  [[nodiscard]] TroubledMaestro& maestro() { return dynamic_cast<TroubledMaestro&>(*bus_); }
  [[nodiscard]] HoldingLine& line() { return *line_; }
  /// A servo on a bus falls silent, and stays where it is. Throws std::bad_cast where it is none.
  void cut_off(std::size_t servo);
  /// Where the servos stand, rad. Any thread.
  [[nodiscard]] JointAngles standing() const;
  /// How far they are from these, rad, but for those that were cut off. Any thread.
  [[nodiscard]] double away_from(const JointAngles& standing, const JointAngles& joints) const;
  /// Whether they stand where the device is in the resting skin. Any thread.
  [[nodiscard]] bool presses() const;

 private:
  [[nodiscard]] std::unique_ptr<BusEmulator> bus_at(const JointAngles& joints) const;
  [[nodiscard]] std::vector<EmulatedServo> servos_at(const JointAngles& joints) const;

  std::shared_ptr<const Device> device_;
  std::filesystem::path name_;
  mutable std::mutex mutex_;  ///< of those below
  std::unique_ptr<BusEmulator> bus_;
  std::unique_ptr<HoldingLine> line_;
  std::unique_ptr<EmulatorTerminal> terminal_;
  std::vector<bool> cut_off_;
};

}  // namespace softfinger
