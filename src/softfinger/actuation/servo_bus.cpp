#include "softfinger/actuation/servo_bus.hpp"

#include <fmt/core.h>

#include "softfinger/actuation/maestro_bus.hpp"
#include "softfinger/actuation/osc_bus.hpp"
#include "softfinger/actuation/servo_table_bus.hpp"
#include "softfinger/actuation/weart_bus.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {

std::unique_ptr<ServoBus> make_servo_bus(const TransportSettings& transport, LineClock& clock) {
  if (transport.kind == "maestro") return std::make_unique<MaestroBus>(transport);
  if (transport.kind == "dynamixel") return make_dynamixel_bus(transport, clock);
  if (transport.kind == "feetech") return make_feetech_bus(transport, clock);
  if (transport.kind == "osc") return std::make_unique<OscBus>(transport);
  if (transport.kind == "weart") return std::make_unique<WeartBus>(transport);
  throw InputError(fmt::format("transport.kind: \"{}\" cannot be driven", transport.kind));
}

}  // namespace softfinger
