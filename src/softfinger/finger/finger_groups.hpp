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

/// A physical surface whose nodes are samples.
struct SampledSurface {
  std::string defect;                         ///< as of FingerGroups
  std::vector<int> sample_nodes;              ///< rising
  std::vector<std::array<int, 3>> triangles;  ///< indices into sample_nodes, outward
};
/// Refused is one that is not there or has triangles inside.
[[nodiscard]] SampledSurface sampled_surface(const TetrahedralMesh& mesh, std::string_view group);
/// Marks the nodes of the physical surfaces of this name.
void mark_surface(const TetrahedralMesh& mesh, std::string_view group, std::vector<bool>& marks);
/// Whether all tetrahedra hang together.
[[nodiscard]] bool is_one_piece(const TetrahedralMesh& mesh);

/// Refused are meshes without skin or bone, with skin inside, without a free node, or with tissue
/// (so skin as well) that is not connected to bone.
[[nodiscard]] FingerGroups group_nodes(const TetrahedralMesh& mesh);

}  // namespace softfinger
