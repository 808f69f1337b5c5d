#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulator_port.hpp"

namespace softfinger {

/// An emulated bus at the far end of a pseudo-terminal, in wall time, with a thread of its own: to
/// the program it is a serial port like any other.
class EmulatorTerminal : public EmulatorPort {
 public:
  /// `emulator` must outlive this. Throws OperationError when the system gives no pseudo-terminal.
  explicit EmulatorTerminal(BusEmulator& emulator);
  ~EmulatorTerminal() override;

  /// Name to open, e.g. /dev/pts/3.
  [[nodiscard]] const std::string& port() const override { return port_; }
  /// Unplugs it: the port is gone for whoever has it open. For good.
  void vanish();

 private:
  void serve();

  BusEmulator& emulator_;
  std::string port_;
  int near_ = -1;  ///< the emulator's end
  int far_ = -1;   ///< the program's end, held open so that the line outlives its users
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace softfinger
