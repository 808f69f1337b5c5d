#pragma once

#include "softfinger/motors/motor_kind.hpp"

namespace softfinger {

[[nodiscard]] const MotorKind& osc_kind();

}  // namespace softfinger
