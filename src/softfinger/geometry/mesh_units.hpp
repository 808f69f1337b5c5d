#pragma once

#include <array>

#include "softfinger/base/name_table.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {

/// What coordinates of a mesh file may be in, m, if its format does not say.
inline constexpr std::array<NameRow<double>, 4> kMeshUnits{{
    {mm, "mm"},
    {10.0 * mm, "cm"},
    {1.0, "m"},
    {25.4 * mm, "inch"},
}};

}  // namespace softfinger
