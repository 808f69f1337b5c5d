#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "softfinger/geometry/tetrahedral_mesh.hpp"
#include "softfinger/geometry/triangle_tree.hpp"

namespace softfinger {

/// The outside of something soft as it stands: all of its boundary, of which a part can be touched.
/// Queries allocate nothing, nor does put().
class DeformingSurface {
 public:
  /// A place on it, by the nodes of the mesh.
  struct Place {
    int triangle = -1;
    std::array<int, 3> nodes{};
    std::array<double, 3> weights{};
    [[nodiscard]] Vector3 at(std::span<const Vector3> positions) const {
      return weights[0] * positions[static_cast<std::size_t>(nodes[0])] +
             weights[1] * positions[static_cast<std::size_t>(nodes[1])] +
             weights[2] * positions[static_cast<std::size_t>(nodes[2])];
    }
  };

  /// Triangles of the physical surface `touching` can be touched. Throws InputError where the
  /// boundary of the tetrahedra is not that of a solid.
  DeformingSurface(const TetrahedralMesh& mesh, std::string_view touching);

  /// All nodes of the mesh stand there, W, m.
  void put(std::span<const Vector3> positions);
  /// The place nearest to p (W, m) and no further than `within` (m); false where there is none, or
  /// it cannot be touched. `near`: a triangle that may be close, or -1.
  [[nodiscard]] bool find(const Vector3& p, double within, int near, Place& place) const;
  /// X_WP of a place: z along the normal, which turns evenly from corner to corner.
  [[nodiscard]] Pose frame(const Place& place) const;
  [[nodiscard]] const Eigen::AlignedBox3d& box() const { return box_; }

 private:
  std::vector<int> nodes_;                  ///< of the mesh, by vertex of the surface
  std::vector<bool> touching_;              ///< by triangle
  std::unique_ptr<ClosedSurface> surface_;  ///< the tree refers to it
  std::unique_ptr<TriangleTree> tree_;
  Eigen::AlignedBox3d box_;
};

}  // namespace softfinger
