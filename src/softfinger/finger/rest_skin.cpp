#include "softfinger/finger/rest_skin.hpp"

#include <array>

namespace softfinger {

std::vector<Vector3> rest_skin_points(const FingerModel& model) {
  std::vector<Vector3> points;
  for (const int node : model.sample_nodes) {
    points.push_back(model.mesh.nodes[static_cast<std::size_t>(node)]);
  }
  for (const std::array<int, 3>& triangle : model.skin_triangles) {
    const auto corner = [&](std::size_t c) {
      return points[static_cast<std::size_t>(triangle[c % 3])];
    };
    const Vector3 centroid = (corner(0) + corner(1) + corner(2)) / 3.0;
    points.push_back(centroid);
    for (std::size_t c = 0; c < 3; ++c) {
      // Each side once, from its corner of lower index; those of the rim may miss.
      if (triangle[c] < triangle[(c + 1) % 3]) {
        points.push_back(0.5 * (corner(c) + corner(c + 1)));
      }
    }
  }
  return points;
}

}  // namespace softfinger
