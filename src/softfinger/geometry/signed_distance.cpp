#include "softfinger/geometry/signed_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/geometry/signed_distance_grid.hpp"

namespace softfinger {

namespace {

// Nearer than this (m) to a centre, an axis or an inner edge, a direction has no meaning left.
constexpr double kNoDirection = 1e-12;

double sign(double value) { return value < 0.0 ? -1.0 : 1.0; }

SignedDistance distance_to(const HalfSpace&, const Vector3& p) {
  return {.distance = p.z(), .gradient = Vector3::UnitZ(), .hessian = Matrix3::Zero()};
}

SignedDistance distance_to(const Ball& ball, const Vector3& p) {
  SignedDistance result;
  const double norm = p.norm();
  result.distance = norm - ball.radius;
  if (norm < kNoDirection) return result;
  result.gradient = p / norm;
  result.hessian = (Matrix3::Identity() - result.gradient * result.gradient.transpose()) / norm;
  return result;
}

// A dilated solid is the set within edge_radius of an inner one, so outside the inner solid its
// distance is that of the inner one minus edge_radius, exactly; inside, the nearest face counts.

SignedDistance distance_to(const RoundedBox& box, const Vector3& p) {
  const Vector3 beyond =
      p.cwiseAbs() - (box.half_size - Vector3::Constant(box.edge_radius));  // of the inner box
  const Vector3 outside = beyond.cwiseMax(0.0);
  const double norm = outside.norm();
  SignedDistance result;
  if (norm < kNoDirection) {
    int face = 0;
    result.distance = beyond.maxCoeff(&face) - box.edge_radius;
    result.gradient = sign(p[face]) * Vector3::Unit(face);
    return result;
  }
  result.distance = norm - box.edge_radius;
  for (int i = 0; i < 3; ++i) result.gradient[i] = sign(p[i]) * outside[i] / norm;
  result.hessian = -result.gradient * result.gradient.transpose() / norm;
  for (int i = 0; i < 3; ++i) {
    // Exactly flat in the direction of a face's normal; and nothing changes along a face.
    if (outside[i] > 0.0) result.hessian(i, i) += 1.0 / norm;
  }
  return result;
}

SignedDistance distance_to(const RoundedCylinder& cylinder, const Vector3& p) {
  const double rho = std::sqrt(p.x() * p.x() + p.y() * p.y());
  const bool on_axis = rho < kNoDirection;
  const Vector3 radial = on_axis ? Vector3::UnitX() : Vector3(p.x() / rho, p.y() / rho, 0.0);
  const Vector3 around(-radial.y(), radial.x(), 0.0);
  const Vector3 axial(0.0, 0.0, sign(p.z()));
  const double r = cylinder.edge_radius;
  const double beyond_side = rho - (cylinder.radius - r);  // of the inner cylinder
  const double beyond_end = std::abs(p.z()) - (cylinder.half_length - r);
  const double side = std::max(beyond_side, 0.0);
  const double end = std::max(beyond_end, 0.0);
  const double norm = std::sqrt(side * side + end * end);
  SignedDistance result;
  if (norm < kNoDirection) {
    const bool nearest_is_side = beyond_side >= beyond_end;
    result.distance = (nearest_is_side ? beyond_side : beyond_end) - r;
    result.gradient = nearest_is_side ? radial : axial;
    if (nearest_is_side && !on_axis) result.hessian = around * around.transpose() / rho;
    return result;
  }
  result.distance = norm - r;
  const double n_side = side / norm;
  const double n_end = end / norm;
  result.gradient = n_side * radial + n_end * axial;
  // In the meridian plane the distance is that to the inner rim, a circle about it.
  if (side > 0.0 && end > 0.0) {
    const Vector3 along = n_end * radial - n_side * axial;
    result.hessian = along * along.transpose() / norm;
  }
  // About the axis. Where the inner cylinder is a mere segment, n_side / rho tends to 1 / norm.
  if (!on_axis) {
    result.hessian += n_side / rho * around * around.transpose();
  } else if (cylinder.radius - r < kNoDirection && end > 0.0) {
    result.hessian = (Matrix3::Identity() - axial * axial.transpose()) / norm;
  }
  return result;
}

SignedDistance distance_to_ball(const Vector3& centre, double radius, const Vector3& p) {
  return distance_to(Ball{radius}, p - centre);
}

SignedDistance distance_to(const TaperedCapsule& capsule, const Vector3& p) {
  // The side is a cone whose normal leans by this much towards the thinner end.
  const double lean = (capsule.back - capsule.front) / (2.0 * capsule.half_length);
  const double across = std::sqrt(1.0 - lean * lean);
  const double rho = std::sqrt(p.y() * p.y() + p.z() * p.z());
  const Vector3 back(-capsule.half_length, 0.0, 0.0);
  const double from_back = p.x() + capsule.half_length;
  const double along_side = across * from_back - lean * rho;  // from where the back's ball ends
  if (along_side <= 0.0) return distance_to_ball(back, capsule.back, p);
  if (along_side >= 2.0 * capsule.half_length * across) {
    return distance_to_ball(-back, capsule.front, p);
  }
  const bool on_axis = rho < kNoDirection;
  const Vector3 radial = on_axis ? Vector3::UnitZ() : Vector3(0.0, p.y() / rho, p.z() / rho);
  SignedDistance result;
  result.distance = across * rho + lean * from_back - capsule.back;
  result.gradient = across * radial + lean * Vector3::UnitX();
  if (on_axis) return result;
  const Vector3 around(0.0, -radial.z(), radial.y());
  result.hessian = across / rho * around * around.transpose();
  return result;
}

SignedDistance distance_to(const MeshShape& mesh, const Vector3& p) {
  return mesh->signed_distance(p);
}

Eigen::AlignedBox3d centred_box(const Vector3& half_size) { return {-half_size, half_size}; }

Eigen::AlignedBox3d bounds_of(const HalfSpace&) {
  return centred_box(Vector3::Constant(std::numeric_limits<double>::infinity()));
}
Eigen::AlignedBox3d bounds_of(const Ball& ball) {
  return centred_box(Vector3::Constant(ball.radius));
}
Eigen::AlignedBox3d bounds_of(const RoundedBox& box) { return centred_box(box.half_size); }
Eigen::AlignedBox3d bounds_of(const RoundedCylinder& cylinder) {
  return centred_box({cylinder.radius, cylinder.radius, cylinder.half_length});
}
Eigen::AlignedBox3d bounds_of(const TaperedCapsule& capsule) {
  const double thickest = std::max(capsule.back, capsule.front);
  return {Vector3(-capsule.half_length - capsule.back, -thickest, -thickest),
          Vector3(capsule.half_length + capsule.front, thickest, thickest)};
}
Eigen::AlignedBox3d bounds_of(const MeshShape& mesh) { return mesh->content().bounds; }

}  // namespace

SignedDistance signed_distance(const Shape& shape, const Vector3& p_O) {
  return std::visit([&](const auto& solid) { return distance_to(solid, p_O); }, shape);
}

SignedDistance distance_and_gradient(const Shape& shape, const Vector3& p_O) {
  if (const auto* mesh = std::get_if<MeshShape>(&shape)) return (*mesh)->distance_and_gradient(p_O);
  return signed_distance(shape, p_O);
}

Eigen::AlignedBox3d bounds(const Shape& shape) {
  return std::visit([](const auto& solid) { return bounds_of(solid); }, shape);
}

}  // namespace softfinger
