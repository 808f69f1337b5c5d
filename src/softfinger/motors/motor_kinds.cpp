#include "softfinger/motors/motor_kinds.hpp"

#include <fmt/core.h>

#include <array>

#include "softfinger/base/error.hpp"
#include "softfinger/motors/dynamixel/dynamixel_kind.hpp"
#include "softfinger/motors/feetech/feetech_kind.hpp"
#include "softfinger/motors/maestro/maestro_kind.hpp"
#include "softfinger/motors/osc/osc_kind.hpp"
#include "softfinger/motors/weart/weart_kind.hpp"

namespace softfinger {

std::span<const MotorKind* const> motor_kinds() {
  static const std::array kKinds{&maestro_kind(), &dynamixel_kind(), &feetech_kind(), &osc_kind(),
                                 &weart_kind()};
  return kKinds;
}

const MotorKind& motor_kind(std::string_view name) {
  for (const MotorKind* kind : motor_kinds()) {
    if (kind->name == name) return *kind;
  }
  throw InputError(fmt::format("transport.kind: \"{}\" cannot be driven", name));
}

const std::vector<std::string>& transport_kinds() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const MotorKind* kind : motor_kinds()) names.emplace_back(kind->name);
    return names;
  }();
  return kNames;
}

}  // namespace softfinger
