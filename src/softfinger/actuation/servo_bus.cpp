#include "softfinger/actuation/servo_bus.hpp"

#include <fmt/core.h>

#include "softfinger/actuation/maestro_bus.hpp"
#include "softfinger/actuation/servo_table_bus.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {

std::unique_ptr<ServoBus> make_servo_bus(const TransportSettings& transport) {
  if (transport.kind == "maestro") return std::make_unique<MaestroBus>(transport);
  if (transport.kind == "dynamixel") return make_dynamixel_bus(transport);
  if (transport.kind == "feetech") return make_feetech_bus(transport);
  throw InputError(fmt::format("transport.kind: \"{}\" cannot be driven yet", transport.kind));
}

}  // namespace softfinger
