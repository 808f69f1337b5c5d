#include "softfinger/geometry/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {

double TriangleTree::Node::squared_distance(const Vector3& p) const {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double beyond = std::max({low[k] - p[k], 0.0, p[k] - high[k]});
    sum += beyond * beyond;
  }
  return sum;
}

bool TriangleTree::Node::meets(const Eigen::AlignedBox3d& box) const {
  for (int k = 0; k < 3; ++k) {
    if (low[k] > box.max()[k] || high[k] < box.min()[k]) return false;
  }
  return true;
}

TriangleTree::Candidate TriangleTree::closest_on(const Leaf& leaf, const Vector3& p) {
  const NearestOnTriangle nearest = nearest_on_triangle(leaf.a, leaf.b, leaf.c, p);
  return {nearest.point, (p - nearest.point).squaredNorm(), leaf.triangle, nearest.feature,
          nearest.k};
}

Vector3 TriangleTree::pseudo_normal(const Candidate& candidate) const {
  const auto t = static_cast<std::size_t>(candidate.triangle);
  const auto k = static_cast<std::size_t>(candidate.k);
  switch (candidate.feature) {
    case Feature::kFace:
      break;
    case Feature::kEdge:
      return face_normals_[t] + face_normals_[static_cast<std::size_t>(surface_->neighbours[t][k])];
    case Feature::kVertex:
      return vertex_normals_[static_cast<std::size_t>(surface_->mesh.triangles[t][k])];
  }
  return face_normals_[t];
}

Vector3 TriangleTree::normal_at(int triangle, const std::array<double, 3>& weights) const {
  const auto t = static_cast<std::size_t>(triangle);
  Vector3 sum = Vector3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto vertex = static_cast<std::size_t>(surface_->mesh.triangles[t][k]);
    sum += weights[k] * vertex_normals_[vertex].normalized();
  }
  const double length = sum.norm();
  return length > 0.0 ? Vector3(sum / length) : face_normals_[t];
}

TriangleTree::Closest TriangleTree::closest(const Vector3& p, int near, double within) const {
  Candidate best{.point = p,
                 .squared_distance = within * within,
                 .triangle = -1,
                 .feature = Feature::kFace,
                 .k = 0};
  if (near >= 0) {
    const Candidate candidate = closest_on(
        {surface_->corner(near, 0), surface_->corner(near, 1), surface_->corner(near, 2), near}, p);
    if (candidate.squared_distance < best.squared_distance) best = candidate;
  }
  struct Waiting {
    std::int32_t node;
    double squared_distance;
  };
  Waiting stack[kDeepest];
  int waiting = 0;
  std::int32_t index = 0;
  double squared_distance = nodes_[0].squared_distance(p);
  while (true) {
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    if (squared_distance < best.squared_distance) {
      if (node.count == 0) {
        Waiting nearer{node.first,
                       nodes_[static_cast<std::size_t>(node.first)].squared_distance(p)};
        Waiting farther{node.first + 1,
                        nodes_[static_cast<std::size_t>(node.first) + 1].squared_distance(p)};
        if (farther.squared_distance < nearer.squared_distance) std::swap(nearer, farther);
        if (farther.squared_distance < best.squared_distance) stack[waiting++] = farther;
        index = nearer.node;
        squared_distance = nearer.squared_distance;
        continue;
      }
      for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
        const Candidate candidate = closest_on(leaves_[static_cast<std::size_t>(i)], p);
        if (candidate.squared_distance < best.squared_distance) best = candidate;
      }
    }
    if (waiting == 0) break;
    --waiting;
    index = stack[waiting].node;
    squared_distance = stack[waiting].squared_distance;
  }
  if (best.triangle < 0) return {p, std::numeric_limits<double>::infinity(), -1};
  const double distance = std::sqrt(best.squared_distance);
  const bool inside = pseudo_normal(best).dot(p - best.point) < 0.0;
  return {best.point, inside ? -distance : distance, best.triangle};
}

int TriangleTree::winding_without(int part, const Vector3& p) const {
  // A direction that runs along no edge people would draw.
  const Vector3 direction(0.5773502, 0.2113249, 0.7886751);
  const Vector3 inverse = direction.cwiseInverse();
  int winding = 0;
  std::int32_t stack[kDeepest];
  int waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--waiting])];
    double enter = 0.0;
    double leave = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      enter = std::max(enter, (node.low[k] - p[k]) * inverse[k]);
      leave = std::min(leave, (node.high[k] - p[k]) * inverse[k]);
    }
    if (enter > leave) continue;
    if (node.count == 0) {
      stack[waiting++] = node.first;
      stack[waiting++] = node.first + 1;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const Leaf& leaf = leaves_[static_cast<std::size_t>(i)];
      if (surface_->part[static_cast<std::size_t>(leaf.triangle)] == part) continue;
      // Moeller and Trumbore 1997.
      const Vector3 ab = leaf.b - leaf.a;
      const Vector3 ac = leaf.c - leaf.a;
      const Vector3 q = direction.cross(ac);
      const double determinant = ab.dot(q);
      if (determinant == 0.0) continue;
      const double u = (p - leaf.a).dot(q) / determinant;
      const Vector3 r = (p - leaf.a).cross(ab);
      const double v = direction.dot(r) / determinant;
      if (u < 0.0 || v < 0.0 || u + v > 1.0 || ac.dot(r) / determinant < 0.0) continue;
      winding += determinant < 0.0 ? 1 : -1;  // leaves through the face's outside
    }
  }
  return winding;
}

}  // namespace softfinger
