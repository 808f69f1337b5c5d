#pragma once

#include "softfinger/motors/motor_kind.hpp"

namespace softfinger {

[[nodiscard]] const MotorKind& weart_kind();

}  // namespace softfinger
