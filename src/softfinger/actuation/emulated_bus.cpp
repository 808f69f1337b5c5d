#include "softfinger/actuation/emulated_bus.hpp"

#include "softfinger/actuation/dynamixel_protocol.hpp"
#include "softfinger/actuation/emulator_terminal.hpp"
#include "softfinger/actuation/feetech_protocol.hpp"
#include "softfinger/actuation/maestro_emulator.hpp"
#include "softfinger/actuation/servo_table_emulator.hpp"

namespace softfinger {

std::unique_ptr<BusEmulator> make_bus_emulator(const TransportSettings& transport,
                                               std::span<const EmulatedServo> servos) {
  if (transport.kind == "dynamixel") {
    return std::make_unique<ServoTableEmulator>(std::make_unique<DynamixelProtocol>(), servos);
  }
  if (transport.kind == "feetech") {
    return std::make_unique<ServoTableEmulator>(std::make_unique<FeetechProtocol>(), servos);
  }
  return std::make_unique<MaestroEmulator>(servos);
}

EmulatedBus::EmulatedBus(const TransportSettings& transport, std::span<const EmulatedServo> servos)
    : emulator_(make_bus_emulator(transport, servos)),
      port_(std::make_unique<EmulatorTerminal>(*emulator_)) {}

}  // namespace softfinger
