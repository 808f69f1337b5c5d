#pragma once

#include <array>
#include <string_view>

#include "softfinger/base/name_table.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {

struct MeshUnit {
  double value;           ///< m
  std::string_view name;  ///< in files
};
/// What coordinates of a mesh file may be in, if its format does not say.
inline constexpr std::array<MeshUnit, 4> kMeshUnits{{
    {mm, "mm"},
    {10.0 * mm, "cm"},
    {1.0, "m"},
    {25.4 * mm, "inch"},
}};

}  // namespace softfinger
