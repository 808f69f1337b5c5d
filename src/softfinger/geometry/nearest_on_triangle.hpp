#pragma once

#include <array>
#include <cstdint>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// The point of a triangle that is nearest to another.
struct NearestOnTriangle {
  enum class Feature : std::uint8_t { kFace, kEdge, kVertex };
  Vector3 point = Vector3::Zero();
  std::array<double, 3> weights{};  ///< of the corners
  Feature feature = Feature::kFace;
  int k = 0;  ///< which edge (k to k + 1) or vertex
};

/// By the Voronoi regions of vertices, edges and face (Ericson, "Real-Time Collision Detection",
/// 2005, section 5.1.5).
[[nodiscard]] inline NearestOnTriangle nearest_on_triangle(const Vector3& a, const Vector3& b,
                                                           const Vector3& c, const Vector3& p) {
  using Feature = NearestOnTriangle::Feature;
  const Vector3 ab = b - a;
  const Vector3 ac = c - a;
  const Vector3 ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, {1.0, 0.0, 0.0}, Feature::kVertex, 0};
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, {0.0, 1.0, 0.0}, Feature::kVertex, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double part = d1 / (d1 - d3);
    return {a + part * ab, {1.0 - part, part, 0.0}, Feature::kEdge, 0};
  }
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, {0.0, 0.0, 1.0}, Feature::kVertex, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double part = d2 / (d2 - d6);
    return {a + part * ac, {1.0 - part, 0.0, part}, Feature::kEdge, 2};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double part = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {b + part * (c - b), {0.0, 1.0 - part, part}, Feature::kEdge, 1};
  }
  const double scale = 1.0 / (va + vb + vc);
  return {a + vb * scale * ab + vc * scale * ac,
          {va * scale, vb * scale, vc * scale},
          Feature::kFace,
          0};
}

}  // namespace softfinger
