#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/geometry/triangle_tree.hpp"

namespace softfinger {
namespace {

constexpr std::int32_t kLeafSize = 4;
constexpr int kBins = 16;
/// Below this the surface area heuristic may still choose; then halves are taken.
constexpr int kDeepestByArea = 56;
/// Twice the area over the square of the longest side: flatter triangles have no normal to speak
/// of.
constexpr double kFlat = 1e-10;

float below(double value) {
  return std::nextafter(static_cast<float>(value), -std::numeric_limits<float>::infinity());
}
float above(double value) {
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

double half_area(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return 0.0;
  const Vector3 s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

/// Angle of a triangle at corner a, rad.
double angle_at(const Vector3& a, const Vector3& b, const Vector3& c) {
  return std::atan2((b - a).cross(c - a).norm(), (b - a).dot(c - a));
}

}  // namespace

TriangleTree::TriangleTree(const ClosedSurface& surface, const std::stop_token& stop)
    : surface_(&surface) {
  StopCheck check(stop);
  compute_normals(check);
  leaves_.reserve(surface.mesh.triangles.size());
  for (int t = 0; t < static_cast<int>(surface.mesh.triangles.size()); ++t) {
    check();
    // All points of a flat triangle are on its neighbours too.
    const Leaf leaf{surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2), t};
    const double longest =
        std::max({(leaf.b - leaf.a).squaredNorm(), (leaf.c - leaf.b).squaredNorm(),
                  (leaf.a - leaf.c).squaredNorm()});
    if ((leaf.b - leaf.a).cross(leaf.c - leaf.a).norm() > kFlat * longest) leaves_.push_back(leaf);
  }
  nodes_.reserve(leaves_.size());
  nodes_.push_back(
      {.low = {}, .high = {}, .first = 0, .count = static_cast<std::int32_t>(leaves_.size())});
  split(0, 0, check);
}

bool TriangleTree::add_normal(int triangle) {
  const auto t = static_cast<std::size_t>(triangle);
  const Vector3 corner[3] = {surface_->corner(triangle, 0), surface_->corner(triangle, 1),
                             surface_->corner(triangle, 2)};
  const Vector3 sides[3] = {corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  const Vector3 normal = sides[0].cross(-sides[2]);
  const double longest =
      std::max({sides[0].squaredNorm(), sides[1].squaredNorm(), sides[2].squaredNorm()});
  if (!(normal.norm() > kFlat * longest)) return false;
  const Vector3 unit = normal.normalized();
  face_normals_[t] = unit;
  for (int k = 0; k < 3; ++k) {
    const auto vertex =
        static_cast<std::size_t>(surface_->mesh.triangles[t][static_cast<std::size_t>(k)]);
    vertex_normals_[vertex] += angle_at(corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]) * unit;
  }
  return true;
}

void TriangleTree::compute_normals(StopCheck& check) {
  const TriangleMesh& mesh = surface_->mesh;
  face_normals_.assign(mesh.triangles.size(), Vector3::Zero());
  vertex_normals_.assign(mesh.positions.size(), Vector3::Zero());
  std::vector<int> flat;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    check();
    if (!add_normal(t)) flat.push_back(t);
  }
  // A flat triangle only stands between its neighbours.
  for (const int t : flat) {
    Vector3 sum = Vector3::Zero();
    for (const int n : surface_->neighbours[static_cast<std::size_t>(t)]) {
      sum += face_normals_[static_cast<std::size_t>(n)];
    }
    if (sum.norm() > 0.0) face_normals_[static_cast<std::size_t>(t)] = sum.normalized();
  }
}

void TriangleTree::refit() {
  for (Leaf& leaf : leaves_) {
    leaf.a = surface_->corner(leaf.triangle, 0);
    leaf.b = surface_->corner(leaf.triangle, 1);
    leaf.c = surface_->corner(leaf.triangle, 2);
  }
  std::fill(vertex_normals_.begin(), vertex_normals_.end(), Vector3::Zero());
  // Where a triangle is flat now, its last normal stays.
  for (const Leaf& leaf : leaves_) static_cast<void>(add_normal(leaf.triangle));
  // Children stand behind their parents.
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    if (node.count > 0) {
      measure_bounds(node);
      continue;
    }
    const Node& a = nodes_[static_cast<std::size_t>(node.first)];
    const Node& b = nodes_[static_cast<std::size_t>(node.first) + 1];
    for (int k = 0; k < 3; ++k) {
      node.low[k] = std::min(a.low[k], b.low[k]);
      node.high[k] = std::max(a.high[k], b.high[k]);
    }
  }
}

void TriangleTree::measure_bounds(Node& node) const {
  Eigen::AlignedBox3d box;
  for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
    const Leaf& leaf = leaves_[static_cast<std::size_t>(i)];
    box.extend(leaf.a).extend(leaf.b).extend(leaf.c);
  }
  for (int k = 0; k < 3; ++k) {
    node.low[k] = below(box.min()[k]);
    node.high[k] = above(box.max()[k]);
  }
}

void TriangleTree::split(std::size_t index, int depth, StopCheck& check) {
  measure_bounds(nodes_[index]);
  const Node node = nodes_[index];
  if (node.count <= kLeafSize) return;
  const std::int32_t middle =
      depth < kDeepestByArea ? partition(node, check) : node.first + node.count / 2;
  const auto child = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back({.low = {}, .high = {}, .first = node.first, .count = middle - node.first});
  nodes_.push_back(
      {.low = {}, .high = {}, .first = middle, .count = node.first + node.count - middle});
  nodes_[index].first = child;
  nodes_[index].count = 0;
  split(static_cast<std::size_t>(child), depth + 1, check);
  split(static_cast<std::size_t>(child) + 1, depth + 1, check);
}

/// Sorts the node's triangles into two groups by the surface area heuristic over bins of their
/// centres; returns where the second begins.
std::int32_t TriangleTree::partition(const Node& node, StopCheck& check) {
  const auto begin = leaves_.begin() + node.first;
  const auto end = begin + node.count;
  const auto centre = [](const Leaf& leaf) -> Vector3 { return (leaf.a + leaf.b + leaf.c) / 3.0; };
  Eigen::AlignedBox3d centres;
  for (auto leaf = begin; leaf != end; ++leaf) centres.extend(centre(*leaf));
  int axis = 0;
  const double width = centres.sizes().maxCoeff(&axis);
  const std::int32_t half = node.first + node.count / 2;
  if (!(width > 0.0)) return half;
  const double low = centres.min()[axis];
  const auto bin_of = [&](const Leaf& leaf) {
    return std::min(kBins - 1, static_cast<int>((centre(leaf)[axis] - low) / width * kBins));
  };
  Eigen::AlignedBox3d boxes[kBins];
  int counts[kBins] = {};
  for (auto leaf = begin; leaf != end; ++leaf) {
    check();
    const int bin = bin_of(*leaf);
    boxes[bin].extend(leaf->a).extend(leaf->b).extend(leaf->c);
    ++counts[bin];
  }
  double right_area[kBins] = {};
  Eigen::AlignedBox3d right;
  for (int bin = kBins - 1; bin > 0; --bin) {
    right.extend(boxes[bin]);
    right_area[bin] = half_area(right);
  }
  Eigen::AlignedBox3d left;
  int left_count = 0;
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int bin = 1; bin < kBins; ++bin) {
    left.extend(boxes[bin - 1]);
    left_count += counts[bin - 1];
    const double cost = left_count * half_area(left) + (node.count - left_count) * right_area[bin];
    if (left_count > 0 && left_count < node.count && cost < least) {
      least = cost;
      best = bin;
    }
  }
  if (best == 0) return half;
  const auto middle =
      std::stable_partition(begin, end, [&](const Leaf& leaf) { return bin_of(leaf) < best; });
  return node.first + static_cast<std::int32_t>(middle - begin);
}

}  // namespace softfinger
