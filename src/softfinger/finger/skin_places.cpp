#include "softfinger/finger/skin_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/geometry/nearest_on_triangle.hpp"

namespace softfinger {
namespace {

using Corners = std::array<Vector3, 3>;
using Weights = std::array<double, 3>;

Corners corners_of(const FingerModel& model, std::size_t triangle) {
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto sample = static_cast<std::size_t>(model.skin_triangles[triangle][k]);
    corners[k] = model.mesh.nodes[static_cast<std::size_t>(model.sample_nodes[sample])];
  }
  return corners;
}

Vector3 at(const Corners& corners, const Weights& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

double longest_side(const Corners& corners) {
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest = std::max(longest, (corners[(k + 1) % 3] - corners[k]).norm());
  }
  return longest;
}

}  // namespace

Vector3 rest_position(const FingerModel& model, const SkinPlace& place) {
  return at(corners_of(model, static_cast<std::size_t>(place.triangle)), place.weights);
}

SkinPlaces even_places(const FingerModel& model, double spacing) {
  SkinPlaces result;
  for (std::size_t t = 0; t < model.skin_triangles.size(); ++t) {
    const Corners corners = corners_of(model, t);
    const int parts = std::max(1, static_cast<int>(std::ceil(longest_side(corners) / spacing)));
    const double area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
    // The parts that stand as the triangle does, and those between them, which stand on their head.
    for (const double third : {1.0, 2.0}) {
      const int most = parts - static_cast<int>(third);
      for (int i = 0; i <= most; ++i) {
        for (int j = 0; i + j <= most; ++j) {
          const auto weight = [&](int k) { return (k + third / 3.0) / parts; };
          result.places.push_back(
              {static_cast<int>(t), {weight(i), weight(j), weight(most - i - j)}});
          result.areas.push_back(area / (parts * parts));
        }
      }
    }
  }
  return result;
}

RestingSkin::RestingSkin(const FingerModel& model) : model_(model) {
  for (std::size_t t = 0; t < model.skin_triangles.size(); ++t) {
    const Corners corners = corners_of(model, t);
    const Vector3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    double radius = 0.0;
    for (const Vector3& corner : corners) radius = std::max(radius, (corner - centre).norm());
    around_.push_back({centre, radius});
  }
}

SkinPlace RestingSkin::nearest(const Vector3& p_F) const {
  SkinPlace best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < around_.size(); ++t) {
    const double reach = around_[t].radius + least;
    if ((p_F - around_[t].centre).squaredNorm() >= reach * reach) continue;
    const Corners corners = corners_of(model_, t);
    const NearestOnTriangle found = nearest_on_triangle(corners[0], corners[1], corners[2], p_F);
    const double distance = (p_F - found.point).norm();
    if (distance >= least) continue;
    least = distance;
    best = {static_cast<int>(t), found.weights};
  }
  return best;
}

}  // namespace softfinger
