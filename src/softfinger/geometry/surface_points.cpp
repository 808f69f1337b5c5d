#include "softfinger/geometry/surface_points.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace softfinger {
namespace {

/// Parts that the edge of a box is cut into, and its faces along each side.
constexpr int kEdgeParts = 4;
/// Points around a rim: a circle that rolls on them goes up and down by radius / 2 (pi / n)^2.
constexpr int kRimPoints = 48;
constexpr int kLengthParts = 4;

struct Points {
  std::vector<SurfacePoint> operator()(const HalfSpace& /*shape*/) const { return {}; }
  std::vector<SurfacePoint> operator()(const Ball& ball) const {
    return {{Vector3::Zero(), ball.radius}};
  }
  std::vector<SurfacePoint> operator()(const RoundedBox& box) const {
    const Vector3 inner = box.half_size.array() - box.edge_radius;
    std::array<std::vector<SurfacePoint>, 3> by_order;  // corners, edges, faces
    const auto is_end = [](int k) { return k == 0 || k == kEdgeParts; };
    // A side of no length is one place, not many.
    const auto parts = [&](int axis) { return inner[axis] > 0.0 ? kEdgeParts : 0; };
    for (int x = 0; x <= parts(0); ++x) {
      for (int y = 0; y <= parts(1); ++y) {
        for (int z = 0; z <= parts(2); ++z) {
          const std::array<int, 3> at{x, y, z};
          int inside = 0;
          Vector3 centre = Vector3::Zero();
          for (int axis = 0; axis < 3; ++axis) {
            const int k = at[static_cast<std::size_t>(axis)];
            if (parts(axis) == 0) continue;
            if (!is_end(k)) ++inside;
            centre[axis] = inner[axis] * (2.0 * k / kEdgeParts - 1.0);
          }
          if (inside > 2) continue;
          by_order[static_cast<std::size_t>(inside)].push_back({centre, box.edge_radius});
        }
      }
    }
    std::vector<SurfacePoint> points;
    for (const auto& some : by_order) points.insert(points.end(), some.begin(), some.end());
    return points;
  }
  std::vector<SurfacePoint> operator()(const RoundedCylinder& cylinder) const {
    const double radius = cylinder.radius - cylinder.edge_radius;
    const double half = cylinder.half_length - cylinder.edge_radius;
    std::vector<SurfacePoint> points;
    const int around = radius > 0.0 ? kRimPoints : 1;
    const int along = half > 0.0 ? kLengthParts : 0;
    // The rims first, then between them.
    for (const bool rim : {true, false}) {
      for (int k = 0; k <= along; ++k) {
        if ((k == 0 || k == along) != rim) continue;
        const double z = along > 0 ? half * (2.0 * k / along - 1.0) : 0.0;
        for (int a = 0; a < around; ++a) {
          const double angle = 2.0 * std::numbers::pi * a / around;
          points.push_back(
              {{radius * std::cos(angle), radius * std::sin(angle), z}, cylinder.edge_radius});
        }
      }
    }
    return points;
  }
  std::vector<SurfacePoint> operator()(const MeshShape& /*mesh*/) const { return {}; }
};

}  // namespace

std::vector<SurfacePoint> surface_points(const Shape& shape) { return std::visit(Points{}, shape); }

}  // namespace softfinger
