#pragma once

#include <span>

#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/motors/maestro/maestro_emulator.hpp"

namespace softfinger {

/// An emulated Maestro on a pseudo-terminal.
class MaestroTerminal {
 public:
  explicit MaestroTerminal(std::span<const EmulatedServo> servos, const MaestroBoard& board = {})
      : emulator_(servos, board), terminal_(emulator_) {}
  [[nodiscard]] const std::string& port() const { return terminal_.port(); }
  [[nodiscard]] const MaestroEmulator& emulator() const { return emulator_; }
  void vanish() { terminal_.vanish(); }

 private:
  MaestroEmulator emulator_;
  EmulatorTerminal terminal_;
};

}  // namespace softfinger
