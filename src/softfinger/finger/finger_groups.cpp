#include "softfinger/finger/finger_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "softfinger/geometry/tetrahedron_faces.hpp"

namespace softfinger {
namespace {

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string listed(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

/// Sets of nodes that tetrahedra join.
class NodeSets {
 public:
  explicit NodeSets(std::size_t nodes) : parent_(nodes) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int root(int node) {
    while (parent(node) != node) node = parent(node) = parent(parent(node));
    return node;
  }
  void join(int a, int b) { parent(root(a)) = root(b); }

 private:
  int& parent(int node) { return parent_[static_cast<std::size_t>(node)]; }
  std::vector<int> parent_;
};

/// Marks the nodes of triangles and tetrahedra that belong to groups of this name.
void mark_group(const TetrahedralMesh& mesh, std::string_view name, std::vector<bool>& marks) {
  mark_surface(mesh, name, marks);
  if (name != kBoneGroup) return;
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    if (mesh.volume_names[static_cast<std::size_t>(mesh.tetrahedron_volume[i])] != name) continue;
    for (const int node : mesh.tetrahedra[i]) marks[static_cast<std::size_t>(node)] = true;
  }
}

std::string find_loose_tissue(const TetrahedralMesh& mesh) {
  NodeSets sets(mesh.nodes.size());
  std::vector<bool> in_tissue(mesh.nodes.size(), false);
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    const auto volume = static_cast<std::size_t>(mesh.tetrahedron_volume[i]);
    if (mesh.volume_names[volume] == kBoneGroup) continue;
    for (const int node : mesh.tetrahedra[i]) {
      in_tissue[static_cast<std::size_t>(node)] = true;
      sets.join(node, mesh.tetrahedra[i][0]);
    }
  }
  std::vector<bool> of_bone(mesh.nodes.size(), false);
  mark_group(mesh, kBoneGroup, of_bone);
  std::set<int> held;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    if (of_bone[node] && in_tissue[node]) held.insert(sets.root(static_cast<int>(node)));
  }
  std::vector<bool> of_skin(mesh.nodes.size(), false);
  mark_group(mesh, kSkinGroup, of_skin);
  std::string defect;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    const bool loose = held.count(sets.root(static_cast<int>(node))) == 0;
    if (of_skin[node] && loose) return "the mesh has skin that is not connected to bone by tissue";
    if (in_tissue[node] && loose) defect = "the mesh has tissue that is not connected to bone";
  }
  return defect;
}

}  // namespace

void mark_surface(const TetrahedralMesh& mesh, std::string_view group, std::vector<bool>& marks) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (mesh.surface_names[static_cast<std::size_t>(mesh.triangle_surface[i])] != group) continue;
    for (const int node : mesh.triangles[i]) marks[static_cast<std::size_t>(node)] = true;
  }
}

bool is_one_piece(const TetrahedralMesh& mesh) {
  NodeSets sets(mesh.nodes.size());
  for (const auto& tetrahedron : mesh.tetrahedra) {
    for (const int node : tetrahedron) sets.join(node, tetrahedron[0]);
  }
  const int root = sets.root(mesh.tetrahedra.front()[0]);
  return std::ranges::all_of(
      mesh.tetrahedra, [&](const auto& tetrahedron) { return sets.root(tetrahedron[0]) == root; });
}

SampledSurface sampled_surface(const TetrahedralMesh& mesh, std::string_view group) {
  SampledSurface surface;
  if (!has(mesh.surface_names, group)) {
    surface.defect = fmt::format("the mesh has no physical surface '{}'; it has: {}", group,
                                 listed(mesh.surface_names));
    return surface;
  }
  const std::vector<TetrahedronFace> faces = faces_of(mesh.tetrahedra);
  std::set<Triangle> seen;
  std::vector<Triangle> skin;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (mesh.surface_names[static_cast<std::size_t>(mesh.triangle_surface[i])] != group) continue;
    if (!seen.insert(sorted(mesh.triangles[i])).second) continue;
    if (find_face(faces, mesh.triangles[i]).size() != 1) {
      surface.defect = fmt::format(
          "the mesh has triangles of group '{0}' inside; {0} is a part of the boundary", group);
      return surface;
    }
    skin.push_back(mesh.triangles[i]);
  }
  std::vector<int> sample_of_node(mesh.nodes.size(), -1);
  for (const Triangle& triangle : skin) {
    for (const int node : triangle) sample_of_node[static_cast<std::size_t>(node)] = 0;
  }
  for (std::size_t node = 0; node < sample_of_node.size(); ++node) {
    if (sample_of_node[node] < 0) continue;
    sample_of_node[node] = static_cast<int>(surface.sample_nodes.size());
    surface.sample_nodes.push_back(static_cast<int>(node));
  }
  for (Triangle triangle : skin) {
    for (int& node : triangle) node = sample_of_node[static_cast<std::size_t>(node)];
    surface.triangles.push_back(triangle);
  }
  return surface;
}

FingerGroups group_nodes(const TetrahedralMesh& mesh) {
  FingerGroups groups;
  SampledSurface skin = sampled_surface(mesh, kSkinGroup);
  if (!has(mesh.surface_names, kSkinGroup)) {
    groups.defect = skin.defect;
    return groups;
  }
  if (!has(mesh.surface_names, kBoneGroup) && !has(mesh.volume_names, kBoneGroup)) {
    groups.defect = fmt::format("the mesh has no physical surface or volume 'bone'; it has: {}",
                                listed(mesh.surface_names));
    return groups;
  }
  groups.node_is_rigid.assign(mesh.nodes.size(), false);
  mark_group(mesh, kBoneGroup, groups.node_is_rigid);
  mark_group(mesh, kNailGroup, groups.node_is_rigid);
  groups.defect = skin.defect;
  groups.sample_nodes = std::move(skin.sample_nodes);
  groups.skin_triangles = std::move(skin.triangles);
  if (groups.defect.empty()) groups.defect = find_loose_tissue(mesh);
  const auto& rigid = groups.node_is_rigid;
  if (groups.defect.empty() && std::find(rigid.begin(), rigid.end(), false) == rigid.end()) {
    groups.defect = "the mesh has no node that is free to move: all belong to bone or nail";
  }
  return groups;
}

}  // namespace softfinger
