#pragma once

#include "softfinger/motors/motor_kind.hpp"

namespace softfinger {

[[nodiscard]] const MotorKind& maestro_kind();

}  // namespace softfinger
