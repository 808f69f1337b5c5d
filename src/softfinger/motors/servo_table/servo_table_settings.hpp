#pragma once

#include "softfinger/motors/motor_kind.hpp"

namespace softfinger {

/// Reads what every servo on a bus has of its `[[transport.servo]]`: an id up to `last_id`, ticks.
[[nodiscard]] ServoSettings read_table_servo(const ConfigTable& table, const std::string& slope,
                                             int last_id);

/// What kinds of servos on a bus have in common; the rest is to be filled in.
[[nodiscard]] MotorKind servo_table_kind();

}  // namespace softfinger
