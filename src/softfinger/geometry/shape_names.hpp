#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "softfinger/base/name_table.hpp"
#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {

/// The alternatives of Shape, in their order.
enum class ShapeKind { kPlane, kSphere, kBox, kCylinder, kMesh, kCapsule };

inline constexpr std::array<NameRow<ShapeKind>, std::variant_size_v<Shape>> kShapes{{
    {ShapeKind::kPlane, "plane"},
    {ShapeKind::kSphere, "sphere"},
    {ShapeKind::kBox, "box"},
    {ShapeKind::kCylinder, "cylinder"},
    {ShapeKind::kMesh, "mesh"},
    {ShapeKind::kCapsule, "capsule"},
}};

/// Those that a scene's object may have: capsules are parts of hands.
[[nodiscard]] inline std::vector<std::string> object_shape_names() {
  std::vector<std::string> names;
  for (const NameRow<ShapeKind>& row : kShapes) {
    if (row.value != ShapeKind::kCapsule) names.emplace_back(row.name);
  }
  return names;
}

/// What a scene calls an object of tetrahedra, which has no Shape.
inline constexpr const char* kSoftShape = "soft";

/// "plane", "sphere", ...
[[nodiscard]] inline std::string_view name_of(const Shape& shape) {
  return row_of(kShapes, static_cast<ShapeKind>(shape.index())).name;
}

}  // namespace softfinger
