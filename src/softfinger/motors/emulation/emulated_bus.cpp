#include "softfinger/motors/emulation/emulated_bus.hpp"

#include "softfinger/motors/emulation/emulator_socket.hpp"
#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/motors/motor_kinds.hpp"

namespace softfinger {

std::unique_ptr<BusEmulator> make_bus_emulator(const TransportSettings& transport,
                                               std::span<const EmulatedServo> servos) {
  return motor_kind(transport.kind).make_emulator(transport, servos);
}

std::unique_ptr<EmulatorPort> make_emulator_port(const TransportSettings& transport,
                                                 BusEmulator& emulator) {
  switch (motor_kind(transport.kind).wire) {
    case MotorKind::Wire::kUdp:
      return std::make_unique<EmulatorSocket>(emulator, EmulatorSocket::Kind::kUdp);
    case MotorKind::Wire::kTcp:
      return std::make_unique<EmulatorSocket>(emulator, EmulatorSocket::Kind::kTcp);
    case MotorKind::Wire::kSerial:
      break;
  }
  return std::make_unique<EmulatorTerminal>(emulator);
}

EmulatedBus::EmulatedBus(const TransportSettings& transport, std::span<const EmulatedServo> servos)
    : emulator_(make_bus_emulator(transport, servos)),
      port_(make_emulator_port(transport, *emulator_)) {}

}  // namespace softfinger
