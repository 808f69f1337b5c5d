#include "softfinger/geometry/surface_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace softfinger {
namespace {

/// Parts that the edge of a box is cut into, and its faces along each side.
constexpr int kEdgeParts = 4;
/// Points around a rim: a circle that rolls on them goes up and down by radius / 2 (pi / n)^2.
constexpr int kRimPoints = 120;  // on 29 mm a hundredth of a millimetre between them
constexpr int kLengthParts = 4;
/// Of the balls along a capsule at most, m.
constexpr double kCapsuleSpacing = 5e-3;

/// Where the distance is almost zero, by its gradient from cells about the surface.
std::vector<Vector3> on_surface(const Shape& shape) {
  constexpr int kSearchCells = 48;  // along the longest side
  constexpr double kOn = 1e-3;      // of a cell
  const Eigen::AlignedBox3d box = bounds(shape);
  const double cell = box.sizes().maxCoeff() / kSearchCells;
  const Eigen::Array3i count = (box.sizes() / cell).array().ceil().cast<int>() + 1;
  std::vector<Vector3> points;
  for (int i = 0; i < count.x(); ++i) {
    for (int j = 0; j < count.y(); ++j) {
      for (int k = 0; k < count.z(); ++k) {
        Vector3 x = box.min() + cell * Eigen::Array3d(i, j, k).matrix();
        SignedDistance at = distance_and_gradient(shape, x);
        if (std::abs(at.distance) > cell) continue;
        for (int step = 0; step < 8; ++step) {
          x -= at.distance * at.gradient / std::max(at.gradient.squaredNorm(), 0.1);
          at = distance_and_gradient(shape, x);
        }
        if (std::abs(at.distance) < kOn * cell) points.push_back(x);
      }
    }
  }
  return points;
}

/// Those that stick out furthest in even directions, corners among them, then whichever is furthest
/// from all before.
std::vector<SurfacePoint> spread(const Shape& shape) {
  constexpr std::size_t kMostPoints = 300;
  constexpr int kDirections = 64;
  const std::vector<Vector3> all = on_surface(shape);
  std::vector<SurfacePoint> points;
  if (all.empty()) return points;
  std::vector<double> distance(all.size(), std::numeric_limits<double>::infinity());
  const auto take = [&](std::size_t index) {
    if (!(distance[index] > 0.0)) return;
    points.push_back({all[index], 0.0});
    for (std::size_t i = 0; i < all.size(); ++i) {
      distance[i] = std::min(distance[i], (all[i] - all[index]).squaredNorm());
    }
  };
  for (int d = 0; d < kDirections; ++d) {
    // A spiral from pole to pole (Saff and Kuijlaars, 1997).
    const double z = 1.0 - (2.0 * d + 1.0) / kDirections;
    const double angle = 3.6 / std::sqrt(kDirections) * d / std::sqrt(1.0 - z * z);
    const double r = std::sqrt(1.0 - z * z);
    const Vector3 direction(r * std::cos(angle), r * std::sin(angle), z);
    const auto furthest =
        std::ranges::max_element(all, {}, [&](const Vector3& x) { return x.dot(direction); });
    take(static_cast<std::size_t>(furthest - all.begin()));
  }
  while (points.size() < kMostPoints) {
    const auto furthest = std::ranges::max_element(distance);
    if (!(*furthest > 0.0)) break;
    take(static_cast<std::size_t>(furthest - distance.begin()));
  }
  return points;
}

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
          points.push_back({{radius * std::cos(angle), radius * std::sin(angle), z},
                            cylinder.edge_radius,
                            around > 1 ? 2.0 * std::numbers::pi / around : 0.0});
        }
      }
    }
    return points;
  }
  std::vector<SurfacePoint> operator()(const MeshShape& mesh) const { return spread(mesh); }
  std::vector<SurfacePoint> operator()(const TaperedCapsule& capsule) const {
    const double length = 2.0 * capsule.half_length;
    const auto parts = static_cast<int>(std::ceil(length / kCapsuleSpacing));
    std::vector<SurfacePoint> points;
    for (int k = 0; k <= parts; ++k) {
      const double at = static_cast<double>(k) / parts;
      const double radius = capsule.back + at * (capsule.front - capsule.back);
      points.push_back({.centre_O = {length * (at - 0.5), 0.0, 0.0},
                        .radius = radius,
                        .area = length / parts * radius});
    }
    return points;
  }
};

}  // namespace

std::vector<SurfacePoint> surface_points(const Shape& shape) { return std::visit(Points{}, shape); }

}  // namespace softfinger
