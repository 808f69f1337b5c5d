#pragma once

#include "softfinger/motors/motor_kind.hpp"

namespace softfinger {

[[nodiscard]] const MotorKind& feetech_kind();

}  // namespace softfinger
