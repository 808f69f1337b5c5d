#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulator_port.hpp"
#include "softfinger/wire/pseudo_terminal.hpp"

namespace softfinger {

/// An emulated bus at the far end of a pseudo-terminal, in wall time, with a thread of its own: to
/// the program it is a serial port like any other.
class EmulatorTerminal : public EmulatorPort {
 public:
  /// `emulator` must outlive this. Throws OperationError when the system gives no pseudo-terminal.
  explicit EmulatorTerminal(BusEmulator& emulator);
  ~EmulatorTerminal() override;

  /// Name to open, e.g. /dev/pts/3.
  [[nodiscard]] const std::string& port() const override { return terminal_.name(); }
  /// Unplugs it: the port is gone for whoever has it open. For good.
  void vanish();

 private:
  void serve();

  BusEmulator& emulator_;
  PseudoTerminal terminal_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace softfinger
