#include "softfinger/actuation/emulated_bus.hpp"

#include "softfinger/actuation/dynamixel_protocol.hpp"
#include "softfinger/actuation/emulator_socket.hpp"
#include "softfinger/actuation/emulator_terminal.hpp"
#include "softfinger/actuation/feetech_protocol.hpp"
#include "softfinger/actuation/maestro_emulator.hpp"
#include "softfinger/actuation/osc_emulator.hpp"
#include "softfinger/actuation/servo_table_emulator.hpp"
#include "softfinger/actuation/weart_emulator.hpp"

namespace softfinger {

std::unique_ptr<BusEmulator> make_bus_emulator(const TransportSettings& transport,
                                               std::span<const EmulatedServo> servos) {
  if (transport.kind == "dynamixel") {
    return std::make_unique<ServoTableEmulator>(std::make_unique<DynamixelProtocol>(), servos);
  }
  if (transport.kind == "feetech") {
    return std::make_unique<ServoTableEmulator>(std::make_unique<FeetechProtocol>(), servos);
  }
  if (transport.kind == "osc") return std::make_unique<OscEmulator>(transport, servos);
  if (transport.kind == "weart") return std::make_unique<WeartEmulator>(transport, servos.front());
  return std::make_unique<MaestroEmulator>(servos);
}

std::unique_ptr<EmulatorPort> make_emulator_port(const TransportSettings& transport,
                                                 BusEmulator& emulator) {
  if (transport.kind == "osc") {
    return std::make_unique<EmulatorSocket>(emulator, EmulatorSocket::Kind::kUdp);
  }
  if (transport.kind == "weart") {
    return std::make_unique<EmulatorSocket>(emulator, EmulatorSocket::Kind::kTcp);
  }
  return std::make_unique<EmulatorTerminal>(emulator);
}

EmulatedBus::EmulatedBus(const TransportSettings& transport, std::span<const EmulatedServo> servos)
    : emulator_(make_bus_emulator(transport, servos)),
      port_(make_emulator_port(transport, *emulator_)) {}

}  // namespace softfinger
