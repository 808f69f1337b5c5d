#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/motors/motor_kind.hpp"

namespace softfinger {

/// Every kind of motors, in the order in which people read of them.
[[nodiscard]] std::span<const MotorKind* const> motor_kinds();
/// The kind of that name; throws InputError where there is none.
[[nodiscard]] const MotorKind& motor_kind(std::string_view name);
/// Their names.
[[nodiscard]] const std::vector<std::string>& transport_kinds();

}  // namespace softfinger
