#pragma once

#include <initializer_list>

#include "draw.hpp"
#include "exploration.hpp"
#include "softfinger/geometry/mesh_shape.hpp"
#include "softfinger/geometry/triangle_mesh.hpp"

namespace softfinger::relations {

/// Objects by what they do to a skin whose samples lie 2 mm apart.
enum class Thing {
  kPlane,
  kBlock,     ///< a box, touched on its upper face
  kBall,      ///< of radius 4 to 40 mm
  kCylinder,  ///< lying, of radius 3 to 20 mm
  kMesh,      ///< a ball of triangles
  kEdge,      ///< a box's edge, rounded by 0.3 to 2 mm, under the pad
  kPlate,     ///< 0.1 to 0.6 mm thick, on edge of nothing
  kBead,      ///< a ball of radius 0.05 to 1 mm
};

inline constexpr std::initializer_list<Thing> kSmoothThings{
    Thing::kPlane, Thing::kBlock, Thing::kBall, Thing::kCylinder, Thing::kMesh};
inline constexpr std::initializer_list<Thing> kSharpThings{Thing::kEdge, Thing::kPlate,
                                                           Thing::kBead};
inline constexpr std::initializer_list<Thing> kAllThings{
    Thing::kPlane, Thing::kBlock, Thing::kBall,  Thing::kCylinder,
    Thing::kMesh,  Thing::kEdge,  Thing::kPlate, Thing::kBead};

/// What the finger does once above the object.
enum class Path { kTap, kPress, kSlide, kRoll };
inline constexpr std::initializer_list<Path> kAllPaths{Path::kTap, Path::kPress, Path::kSlide,
                                                       Path::kRoll};

/// The solid that a mesh encloses.
[[nodiscard]] MeshShape solid_of(TriangleMesh mesh);
/// A shipped finger, of drawn sizes.
[[nodiscard]] std::shared_ptr<const FingerModel> draw_finger(Draw& draw, std::string& what);
/// The object, its top at z = 0 of W below the origin; mu 0 to 1.
[[nodiscard]] VirtualObject draw_object(Draw& draw, Thing thing, std::string& what);
/// X_WFt over `object` where it just touches: over the origin, turned like `turn`. The skin is what
/// its triangles at rest have of it.
[[nodiscard]] Pose touching(const FingerModel& model, const VirtualObject& object,
                            const Matrix3& turn);

/// One case of a relation: the case's number goes round the things and paths, all else is drawn. At
/// most half a second, 0.7 to 1.6 mm deep.
[[nodiscard]] Exploration draw_exploration(Draw& draw, int number,
                                           std::initializer_list<Thing> things,
                                           std::initializer_list<Path> paths = kAllPaths);

}  // namespace softfinger::relations
