#pragma once

#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {

/// The side of a solid that a point of the skin came to it from: where its surface is, and its unit
/// outward normal there, in the solid's frame O.
struct ContactSide {
  Vector3 point_O = Vector3::Zero();
  Vector3 normal_O = Vector3::UnitZ();
  bool known = false;
};

/// Signed distance of p_O to the solid as seen from `side`. The nearest surface of a thin solid is
/// its far side from halfway through: where that is so, the side's tangent plane counts instead,
/// `behind` is true and the Hessian zero. The plane ends where the solid does, so a point that went
/// around an edge is not behind. Without a known side, the signed distance.
struct DistanceFromSide {
  SignedDistance at;
  bool behind = false;
};
[[nodiscard]] DistanceFromSide distance_from_side(const Shape& shape, const ContactSide& side,
                                                  const Vector3& p_O);
/// Whether p_O, at `at` (signed_distance() there), is behind the side's tangent plane.
[[nodiscard]] bool is_behind(const Shape& shape, const ContactSide& side, const Vector3& p_O,
                             const SignedDistance& at);
/// What the side's tangent plane is at p_O.
[[nodiscard]] SignedDistance distance_to_side(const ContactSide& side, const Vector3& p_O);

/// The side where the straight way from `from_O`, outside, to `to_O` first meets the solid; unknown
/// where it does not, or begins inside.
[[nodiscard]] ContactSide side_on_way(const Shape& shape, const Vector3& from_O,
                                      const Vector3& to_O);
/// Whether `at` (signed_distance() at to_O) leaves it open that the way there went through.
[[nodiscard]] bool may_have_passed(const Shape& shape, const Vector3& from_O, const Vector3& to_O,
                                   const SignedDistance& at);

/// The side that a point at p_O is on afterwards: of the surface nearest to it, or where it is
/// behind `side`, of the surface above it on that side.
[[nodiscard]] ContactSide side_at(const SignedDistance& at, const Vector3& p_O);
[[nodiscard]] ContactSide side_above(const Shape& shape, const ContactSide& side,
                                     const Vector3& p_O);

}  // namespace softfinger
