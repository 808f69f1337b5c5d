#pragma once

#include <array>
#include <string_view>

namespace softfinger {

/// What `[matching] objective` of a device file may say, the first where it says nothing. What they
/// are stands in objectives/objective_kinds.cpp, which does not compile where this differs from it.
inline constexpr std::array<std::string_view, 3> kDeviceObjectives{"surface", "surface_and_force",
                                                                   "stress"};

}  // namespace softfinger
