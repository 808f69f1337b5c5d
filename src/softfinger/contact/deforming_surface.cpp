#include "softfinger/contact/deforming_surface.hpp"

#include <set>

#include "softfinger/geometry/tetrahedron_faces.hpp"

namespace softfinger {
namespace {

std::set<Triangle> triangles_named(const TetrahedralMesh& mesh, std::string_view group) {
  std::set<Triangle> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.surface_names[static_cast<std::size_t>(mesh.triangle_surface[t])] != group) continue;
    triangles.insert(sorted(mesh.triangles[t]));
  }
  return triangles;
}

}  // namespace

DeformingSurface::DeformingSurface(const TetrahedralMesh& mesh, std::string_view touching) {
  const std::set<Triangle> named = triangles_named(mesh, touching);
  std::vector<int> vertex_of_node(mesh.nodes.size(), -1);
  TriangleMesh boundary;
  const std::vector<TetrahedronFace> faces = faces_of(mesh.tetrahedra);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const bool shared = (f > 0 && faces[f - 1].sorted == faces[f].sorted) ||
                        (f + 1 < faces.size() && faces[f + 1].sorted == faces[f].sorted);
    if (shared) continue;
    Triangle triangle = faces[f].outward;
    for (int& node : triangle) {
      int& vertex = vertex_of_node[static_cast<std::size_t>(node)];
      if (vertex < 0) {
        vertex = static_cast<int>(nodes_.size());
        nodes_.push_back(node);
        boundary.positions.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
      }
      node = vertex;
    }
    boundary.triangles.push_back(triangle);
    touching_.push_back(named.contains(faces[f].sorted));
  }
  surface_ = std::make_unique<ClosedSurface>(closed_surface(std::move(boundary), "the mesh"));
  tree_ = std::make_unique<TriangleTree>(*surface_);
  put(mesh.nodes);
}

void DeformingSurface::put(std::span<const Vector3> positions) {
  box_.setEmpty();
  for (std::size_t v = 0; v < nodes_.size(); ++v) {
    surface_->mesh.positions[v] = positions[static_cast<std::size_t>(nodes_[v])];
    box_.extend(surface_->mesh.positions[v]);
  }
  tree_->refit();
}

bool DeformingSurface::find(const Vector3& p, double within, int near, Place& place) const {
  if (box_.squaredExteriorDistance(p) > within * within) return false;
  const TriangleTree::Closest closest = tree_->closest(p, near, within);
  if (closest.triangle < 0) return false;
  const auto t = static_cast<std::size_t>(closest.triangle);
  if (!touching_[t]) return false;
  place.triangle = closest.triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    place.nodes[k] = nodes_[static_cast<std::size_t>(surface_->mesh.triangles[t][k])];
  }
  place.weights = nearest_on_triangle(surface_->corner(closest.triangle, 0),
                                      surface_->corner(closest.triangle, 1),
                                      surface_->corner(closest.triangle, 2), p)
                      .weights;
  return true;
}

Pose DeformingSurface::frame(const Place& place) const {
  Pose X_WP;
  for (int k = 0; k < 3; ++k) {
    X_WP.translation +=
        place.weights[static_cast<std::size_t>(k)] * surface_->corner(place.triangle, k);
  }
  const Vector3 z = tree_->normal_at(place.triangle, place.weights);
  const Vector3 side = surface_->corner(place.triangle, 1) - surface_->corner(place.triangle, 0);
  const Vector3 y = z.cross(side).normalized();
  X_WP.rotation << y.cross(z), y, z;
  return X_WP;
}

}  // namespace softfinger
