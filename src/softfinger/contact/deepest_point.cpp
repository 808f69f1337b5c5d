#include "softfinger/contact/deepest_point.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

using Corners = std::array<Vector3, 3>;
using Weights = std::array<double, 3>;

constexpr int kIterations = 6;
/// By how much a solid is shrunk where it is flat, m.
constexpr double kShrink = 3e-4;
constexpr double kWorthwhile = 1e-7;  // m

/// How far below a point the solid shrinks to nothing: its surface's nearest centre of curvature,
/// so that a ball or an edge is found at once. Of the Hessian's eigenvalues one is 0, along the
/// gradient.
double way_to_core(const SignedDistance& at) {
  const double sum = at.hessian.trace();
  const double product_twice = sum * sum - at.hessian.squaredNorm();
  const double greatest = 0.5 * (sum + std::sqrt(std::max(0.0, sum * sum - 2.0 * product_twice)));
  return greatest * (std::abs(at.distance) + kShrink) > 1e-3
             ? 1.0 / greatest
             : at.distance + kShrink + std::max(0.0, -at.distance);
}

/// Barycentric weights of the point of the triangle nearest to p.
Weights closest_weights(const Corners& c, const Vector3& p) {
  const Vector3 a = c[1] - c[0];
  const Vector3 b = c[2] - c[0];
  const Vector3 r = p - c[0];
  const double aa = a.dot(a);
  const double ab = a.dot(b);
  const double bb = b.dot(b);
  const double determinant = aa * bb - ab * ab;
  if (determinant > 0.0) {
    const double u = (bb * a.dot(r) - ab * b.dot(r)) / determinant;
    const double v = (aa * b.dot(r) - ab * a.dot(r)) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) return {1.0 - u - v, u, v};
  }
  Weights nearest{1.0, 0.0, 0.0};
  double least = r.squaredNorm();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vector3 edge = c[next] - c[k];
    const double length_squared = edge.squaredNorm();
    const double t =
        length_squared > 0.0 ? std::clamp(edge.dot(p - c[k]) / length_squared, 0.0, 1.0) : 0.0;
    const double distance = (c[k] + t * edge - p).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = {0.0, 0.0, 0.0};
    nearest[k] = 1.0 - t;
    nearest[next] = t;
  }
  return nearest;
}

}  // namespace

TrianglePoint deepest_point(const Shape& shape, const ContactSide& side, const Corners& corners_O,
                            const TrianglePoint& start) {
  TrianglePoint best = start;
  Vector3 p = point_at(corners_O, best.weights);
  SignedDistance at = distance_from_side(shape, side, p).at;
  best.gap = at.distance;
  double way = way_to_core(at);
  for (int i = 0; i < kIterations; ++i) {
    const Weights weights = closest_weights(corners_O, p - way * at.gradient);
    const Vector3 moved = point_at(corners_O, weights);
    const SignedDistance there = distance_from_side(shape, side, moved).at;
    if (there.distance > best.gap - kWorthwhile) {
      if (there.distance > best.gap + kWorthwhile) {
        way *= 0.5;
        continue;
      }
      break;
    }
    best = {weights, there.distance};
    p = moved;
    at = there;
    way = way_to_core(at);
  }
  return best;
}

TrianglePoint least_of_few(const Shape& shape, const ContactSide& side, const Corners& corners_O) {
  constexpr std::array<Weights, 4> kFew{{{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0},
                                         {2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0},
                                         {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0},
                                         {1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0}}};
  const auto gap = [&](const Weights& weights) {
    return distance_from_side(shape, side, point_at(corners_O, weights)).at.distance;
  };
  TrianglePoint least{kFew[0], gap(kFew[0])};
  for (std::size_t k = 1; k < kFew.size(); ++k) {
    const double here = gap(kFew[k]);
    if (here < least.gap) least = {kFew[k], here};
  }
  return least;
}

}  // namespace softfinger
