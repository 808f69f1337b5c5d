#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/motors/maestro/maestro_emulator.hpp"

namespace softfinger {

/// An emulated Maestro that may lose its power in the middle of a command, and whose line may cut
/// what it carries.
class TroubledMaestro final : public BusEmulator {
 public:
  explicit TroubledMaestro(std::span<const EmulatedServo> servos) : maestro_(servos) {}

  void receive(std::span<const std::uint8_t> bytes) override;
  std::size_t take_replies(std::span<std::uint8_t> out) override;
  void advance_to(double time) override { maestro_.advance_to(time); }
  [[nodiscard]] double setpoint(std::size_t servo) const override {
    return maestro_.setpoint(servo);
  }

  /// In the middle of the bytes that come next. Any thread.
  void reset() { reset_ = true; }
  /// Whether three packets in ten are cut in half, both ways, but no two in a row. Any thread.
  void cut(bool yes) { cutting_ = yes; }

 private:
  bool cuts();

  MaestroEmulator maestro_;
  std::atomic<bool> reset_{false};
  std::atomic<bool> cutting_{false};
  bool cut_before_ = false;
  std::mt19937_64 random_{7};
};

/// Such a board at the end of a cable that may be pulled, under a name that stays.
class TroubledBoard {
 public:
  /// Servos at the device's home. The device's transport is a Maestro's. `name`: of the port.
  TroubledBoard(std::shared_ptr<const Device> device, std::filesystem::path name);
  ~TroubledBoard();
  TroubledBoard(const TroubledBoard&) = delete;
  TroubledBoard& operator=(const TroubledBoard&) = delete;

  [[nodiscard]] std::string port() const { return name_.string(); }
  void pull();
  /// A pulled cable is back; the board has kept its power and its servos their place.
  void plug_in();
  [[nodiscard]] TroubledMaestro& maestro() { return *maestro_; }
  /// Where the servos stand, rad. Any thread.
  [[nodiscard]] JointAngles standing() const;

 private:
  [[nodiscard]] std::vector<EmulatedServo> servos_at(const JointAngles& joints) const;

  std::shared_ptr<const Device> device_;
  std::filesystem::path name_;
  mutable std::mutex mutex_;  ///< of those below
  std::unique_ptr<TroubledMaestro> maestro_;
  std::unique_ptr<EmulatorTerminal> terminal_;
};

}  // namespace softfinger
