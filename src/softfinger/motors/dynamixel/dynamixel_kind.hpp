#pragma once

#include "softfinger/motors/motor_kind.hpp"

namespace softfinger {

[[nodiscard]] const MotorKind& dynamixel_kind();

}  // namespace softfinger
