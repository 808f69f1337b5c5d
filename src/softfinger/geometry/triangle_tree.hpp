#pragma once

#include <cstdint>
#include <limits>
#include <stop_token>
#include <vector>

#include "softfinger/base/stop_check.hpp"
#include "softfinger/geometry/closed_surface.hpp"
#include "softfinger/geometry/nearest_on_triangle.hpp"

namespace softfinger {

/// Bounding volume hierarchy over the triangles of a closed surface, for exact distances. Refers to
/// the surface, which must outlive it. Queries allocate nothing and may run at the same time.
class TriangleTree {
 public:
  /// Throws InputError when `stop` asks for an end.
  explicit TriangleTree(const ClosedSurface& surface, const std::stop_token& stop = {});

  /// The surface's vertices have moved: what is known of them follows, the hierarchy stays.
  /// Allocates nothing.
  void refit();
  /// Unit normal at a point of a triangle by its corners' weights, turning evenly between the
  /// normals at the corners, which are weighted by angle.
  [[nodiscard]] Vector3 normal_at(int triangle, const std::array<double, 3>& weights) const;

  struct Closest {
    Vector3 point = Vector3::Zero();  ///< of the surface, m
    double distance = 0.0;            ///< m, positive outside, negative inside
    int triangle = 0;                 ///< one that has the point
  };
  /// Exact; the sign is that of the angle-weighted pseudo-normal of the face, edge or vertex
  /// nearest to p (Baerentzen and Aanaes, "Signed distance computation using the angle weighted
  /// pseudonormal", IEEE TVCG 2005). Two hints save time: `near`, a triangle that may be close, and
  /// `within` (m), beyond which nothing is searched; the distance is infinite where nothing is
  /// found.
  [[nodiscard]] Closest closest(const Vector3& p, int near = -1,
                                double within = std::numeric_limits<double>::infinity()) const;

  /// How often the rest of the surface, without one of its parts, winds around p: 0 outside, 1
  /// inside.
  [[nodiscard]] int winding_without(int part, const Vector3& p) const;

  /// Calls visit(triangle) for each triangle whose box meets `box`, until it returns true.
  template <typename Visit>
  void overlapping(const Eigen::AlignedBox3d& box, Visit&& visit) const {
    std::int32_t stack[kDeepest];
    int waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
      const Node& node = nodes_[static_cast<std::size_t>(stack[--waiting])];
      if (!node.meets(box)) continue;
      if (node.count == 0) {
        stack[waiting++] = node.first;
        stack[waiting++] = node.first + 1;
        continue;
      }
      for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
        if (visit(leaves_[static_cast<std::size_t>(i)].triangle)) return;
      }
    }
  }

 private:
  static constexpr int kDeepest = 96;
  struct Node {
    float low[3];
    float high[3];
    std::int32_t first = 0;  ///< of two children that lie together, or of the leaf's triangles
    std::int32_t count = 0;  ///< of the leaf's triangles; 0: has children

    [[nodiscard]] double squared_distance(const Vector3& p) const;
    [[nodiscard]] bool meets(const Eigen::AlignedBox3d& box) const;
  };
  struct Leaf {
    Vector3 a, b, c;
    int triangle;
  };
  using Feature = NearestOnTriangle::Feature;
  struct Candidate {
    Vector3 point;
    double squared_distance;
    int triangle;
    Feature feature;
    int k;  ///< which edge or vertex of the triangle
  };
  struct Builder;

  static Candidate closest_on(const Leaf& leaf, const Vector3& p);
  [[nodiscard]] Vector3 pseudo_normal(const Candidate& candidate) const;
  void compute_normals(StopCheck& check);
  /// False where it is too flat to have one.
  bool add_normal(int triangle);
  void measure_bounds(Node& node) const;
  void split(std::size_t node, int depth, StopCheck& check);
  [[nodiscard]] std::int32_t partition(const Node& node, StopCheck& check);

  const ClosedSurface* surface_;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  std::vector<Vector3> face_normals_;    ///< unit, per triangle
  std::vector<Vector3> vertex_normals_;  ///< weighted by angle, any length
};

}  // namespace softfinger
