#pragma once

#include <memory>
#include <span>
#include <string>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulated_servo.hpp"
#include "softfinger/motors/emulation/emulator_port.hpp"
#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// An emulator for the bus of a `[transport]`.
[[nodiscard]] std::unique_ptr<BusEmulator> make_bus_emulator(const TransportSettings& transport,
                                                             std::span<const EmulatedServo> servos);

/// The port of such an emulator; it must outlive the port.
[[nodiscard]] std::unique_ptr<EmulatorPort> make_emulator_port(const TransportSettings& transport,
                                                               BusEmulator& emulator);

/// An emulator behind a port of its own: what `port = "emulator"` speaks to in wall time.
class EmulatedBus {
 public:
  /// Throws OperationError when the system gives no port.
  EmulatedBus(const TransportSettings& transport, std::span<const EmulatedServo> servos);

  [[nodiscard]] const std::string& port() const { return port_->port(); }
  [[nodiscard]] const BusEmulator& emulator() const { return *emulator_; }

 private:
  std::unique_ptr<BusEmulator> emulator_;
  std::unique_ptr<EmulatorPort> port_;
};

}  // namespace softfinger
