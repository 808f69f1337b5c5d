#pragma once

#include <atomic>
#include <span>
#include <string>
#include <thread>

#include "softfinger/actuation/maestro_emulator.hpp"

namespace softfinger {

/// An emulated controller at the far end of a pseudo-terminal, in wall time, with a thread of its
/// own: to the program it is a serial port like any other.
class EmulatorTerminal {
 public:
  /// Throws OperationError when the system gives no pseudo-terminal.
  explicit EmulatorTerminal(std::span<const EmulatedServo> servos);
  ~EmulatorTerminal();
  EmulatorTerminal(const EmulatorTerminal&) = delete;
  EmulatorTerminal& operator=(const EmulatorTerminal&) = delete;

  /// Name to open, e.g. /dev/pts/3.
  [[nodiscard]] const std::string& port() const { return port_; }
  [[nodiscard]] const MaestroEmulator& emulator() const { return emulator_; }
  /// Unplugs it: the port is gone for whoever has it open. For good.
  void vanish();

 private:
  void serve();

  MaestroEmulator emulator_;
  std::string port_;
  int near_ = -1;  ///< the emulator's end
  int far_ = -1;   ///< the program's end, held open so that the line outlives its users
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace softfinger
