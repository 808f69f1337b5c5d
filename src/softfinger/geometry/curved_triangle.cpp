#include "softfinger/geometry/curved_triangle.hpp"

#include <cstddef>

namespace softfinger {
namespace {

/// A third of the way from a to b, in the plane through a.
Vector3 third_of_way(const Vector3& a, const Vector3& normal, const Vector3& b) {
  return (2.0 * a + b - (b - a).dot(normal) * normal) / 3.0;
}

}  // namespace

CurvedTriangle::CurvedTriangle(const std::array<Vector3, 3>& corners,
                               const std::array<Vector3, 3>& normals) {
  Vector3 sides = Vector3::Zero();
  Vector3 sum = Vector3::Zero();
  for (int k = 0; k < 3; ++k) {
    const auto first = static_cast<std::size_t>(k), second = (first + 1) % 3;
    const Vector3 near_first = third_of_way(corners[first], normals[first], corners[second]);
    const Vector3 near_second = third_of_way(corners[second], normals[second], corners[first]);
    control_points_.col(k) = corners[first];
    control_points_.col(3 + 2 * k) = near_first;
    control_points_.col(4 + 2 * k) = near_second;
    sides += near_first + near_second;
    sum += corners[first];
  }
  control_points_.col(9) = 0.25 * sides - sum / 6.0;
}

CurvedTriangle::Basis CurvedTriangle::basis(const std::array<double, 3>& weights) {
  Basis basis;
  for (int k = 0; k < 3; ++k) {
    const double a = weights[static_cast<std::size_t>(k)];
    const double b = weights[static_cast<std::size_t>((k + 1) % 3)];
    basis[k] = a * a * a;
    basis[3 + 2 * k] = 3.0 * a * a * b;
    basis[4 + 2 * k] = 3.0 * a * b * b;
  }
  basis[9] = 6.0 * weights[0] * weights[1] * weights[2];
  return basis;
}

}  // namespace softfinger
