#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/geometry/tetrahedral_mesh.hpp"

namespace softfinger {

// Names of physical groups with a meaning.
inline constexpr std::string_view kSkinGroup = "skin";
inline constexpr std::string_view kBoneGroup = "bone";
inline constexpr std::string_view kNailGroup = "nail";

/// What the groups of a finger's mesh say about its nodes.
struct FingerGroups {
  std::string defect;             ///< why the mesh is no finger, in one line; empty if it is one
  std::vector<int> sample_nodes;  ///< nodes of the group `skin`, rising
  std::vector<std::array<int, 3>> skin_triangles;  ///< indices into sample_nodes, outward
  std::vector<bool> node_is_rigid;  ///< of the surfaces `bone` and `nail` and of the volume `bone`
};

/// Refused are meshes without skin or bone, with skin inside, without a free node, or with tissue
/// (so skin as well) that is not connected to bone.
[[nodiscard]] FingerGroups group_nodes(const TetrahedralMesh& mesh);

}  // namespace softfinger
