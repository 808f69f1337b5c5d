#include "softfinger/contact/contact_side.hpp"

#include <algorithm>

namespace softfinger {
namespace {

/// Greatest slope of a mesh's interpolated distance; the true one has 1.
constexpr double kSteepestSide = 1.5;
/// As near as this a way has met the solid, m.
constexpr double kMet = 1e-7;
/// A way that leaves the solid at a flat angle takes many; one that takes more has not met it.
constexpr int kMostAdvances = 128;
/// A side's plane reaches beyond the solid by this part of the depth below it.
constexpr double kOverhang = 0.5;

double steepest(const Shape& shape) {
  return std::holds_alternative<MeshShape>(shape) ? kSteepestSide : 1.0;
}

}  // namespace

SignedDistance distance_to_side(const ContactSide& side, const Vector3& p_O) {
  return {.distance = side.normal_O.dot(p_O - side.point_O),
          .gradient = side.normal_O,
          .hessian = Matrix3::Zero()};
}

bool is_behind(const Shape& shape, const ContactSide& side, const Vector3& p_O,
               const SignedDistance& at) {
  if (!side.known || at.gradient.dot(side.normal_O) >= 0.0) return false;
  const double height = side.normal_O.dot(p_O - side.point_O);
  if (height >= 0.0) return false;
  const Vector3 above = p_O - height * side.normal_O;
  return distance_and_gradient(shape, above).distance < kOverhang * -height;
}

DistanceFromSide distance_from_side(const Shape& shape, const ContactSide& side,
                                    const Vector3& p_O) {
  DistanceFromSide result;
  result.at = distance_and_gradient(shape, p_O);
  result.behind = is_behind(shape, side, p_O, result.at);
  if (result.behind) result.at = distance_to_side(side, p_O);
  return result;
}

bool may_have_passed(const Shape& shape, const Vector3& from_O, const Vector3& to_O,
                     const SignedDistance& at) {
  const Vector3 way = to_O - from_O;
  // What is behind a solid sees the surface from the other side.
  return way.dot(at.gradient) > 0.0 && at.distance < steepest(shape) * way.norm();
}

ContactSide side_on_way(const Shape& shape, const Vector3& from_O, const Vector3& to_O) {
  const double length = (to_O - from_O).norm();
  SignedDistance at = distance_and_gradient(shape, from_O);
  if (at.distance < 0.0 || !(length > 0.0)) return {};
  const Vector3 direction = (to_O - from_O) / length;
  double gone = 0.0;
  Vector3 p = from_O;
  for (int i = 0; i < kMostAdvances && at.distance > kMet; ++i) {
    gone += at.distance / steepest(shape);
    if (gone >= length) return {};
    p = from_O + gone * direction;
    at = distance_and_gradient(shape, p);
  }
  if (at.distance > kMet) return {};
  return side_at(at, p);
}

ContactSide side_at(const SignedDistance& at, const Vector3& p_O) {
  const double slope_squared = at.gradient.squaredNorm();
  if (!(slope_squared > 0.0)) return {};
  return {p_O - at.distance / slope_squared * at.gradient, at.gradient.normalized(), true};
}

ContactSide side_above(const Shape& shape, const ContactSide& side, const Vector3& p_O) {
  const Vector3 above = p_O - distance_to_side(side, p_O).distance * side.normal_O;
  const SignedDistance at = distance_and_gradient(shape, above);
  // Thin as it is, its surface there may be the other one's: the plane goes on then.
  if (at.gradient.dot(side.normal_O) <= 0.5) return {above, side.normal_O, true};
  return side_at(at, above);
}

}  // namespace softfinger
