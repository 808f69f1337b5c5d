#include "softfinger/motors/servo_bus.hpp"

#include "softfinger/motors/motor_kinds.hpp"

namespace softfinger {

std::unique_ptr<ServoBus> make_servo_bus(const TransportSettings& transport, LineClock& clock) {
  return motor_kind(transport.kind).make_bus(transport, clock);
}

}  // namespace softfinger
