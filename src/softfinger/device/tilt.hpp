#pragma once

#include "softfinger/device/plane_function.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// The rotation M = exp((roll, pitch, 0)) of a platform without torsion, in factors that keep their
/// derivatives: with t^2 = pitch^2 + roll^2, sine = sin t / t and cosine = (1 - cos t) / t^2,
///   M = [1 - cosine p p    cosine p r      sine p      ]
///       [cosine p r        1 - cosine r r  -sine r     ]
///       [-sine p           sine r          1 - cosine (p p + r r)].
struct Tilt {
  Tilt(double pitch, double roll);

  PlaneFunction sine, cosine;
  PlaneFunction sine_p, sine_r;                   ///< sine * pitch, sine * roll
  PlaneFunction cosine_pp, cosine_pr, cosine_rr;  ///< cosine * pitch^2, ...

  [[nodiscard]] Matrix3 rotation() const;
  /// Which derivative of the rotation to take: first by pitch or roll, second by both.
  [[nodiscard]] Matrix3 derivative(double PlaneFunction::*part) const;
};

}  // namespace softfinger
