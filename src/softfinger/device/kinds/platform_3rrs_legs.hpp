#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/device/kinds/platform_3rrs.hpp"
#include "softfinger/device/tilt.hpp"

namespace softfinger {

// Inline, so that what a caller does not use of the derivatives costs nothing.

/// Cosine and sine of the legs' azimuths 0, 120, 240 degrees.
inline constexpr std::array<double, 3> kLegCosine{1.0, -0.5, -0.5};
inline constexpr std::array<double, 3> kLegSine{0.0, 0.86602540378443864676,
                                                -0.86602540378443864676};

/// Platform joint of one leg in the leg's plane, relative to the base joint: x outward, y towards
/// the platform; m. Functions of pitch and roll; dx/dtravel = 0, dy/dtravel = -1.
struct LegPosture {
  PlaneFunction x, y;
};

[[nodiscard]] inline LegPosture leg_posture(const Platform3rrsGeometry& geometry, const Tilt& tilt,
                                            double travel, int leg) {
  const auto i = static_cast<std::size_t>(leg);
  const double c = kLegCosine[i];
  const double s = kLegSine[i];
  const double rp = geometry.platform_radius;
  // u . (centre + rp M u) with the centre's parasitic shift worked in.
  LegPosture posture;
  posture.x = (rp * (-0.5 * c - c * c)) * tilt.cosine_pp +
              (rp * (2.0 * c * s - s)) * tilt.cosine_pr + (rp * (0.5 * c - s * s)) * tilt.cosine_rr;
  posture.x.v += rp - geometry.base_radius;
  posture.y = (rp * c) * tilt.sine_p + (-rp * s) * tilt.sine_r;
  posture.y.v += geometry.neutral_height - travel;
  return posture;
}

/// Centre of the platform in B' with derivatives by pitch and roll; z is travel.
struct PlatformCentre {
  PlaneFunction x, y;
};
[[nodiscard]] inline PlatformCentre platform_centre(const Platform3rrsGeometry& geometry,
                                                    const Tilt& tilt) {
  const double rp = geometry.platform_radius;
  return {(0.5 * rp) * (tilt.cosine_rr + (-1.0) * tilt.cosine_pp), (-rp) * tilt.cosine_pr};
}

/// The crank angle, knee outward, for the platform joint at (x, y), with derivatives by x and y.
struct CrankAngle {
  double angle = 0.0;
  double dx = 0.0, dy = 0.0;
  double dxx = 0.0, dxy = 0.0, dyy = 0.0;
};
/// False where crank and coupler do not reach (x, y), or only just: then only `angle` may be used,
/// with the arccosine's argument cut to [-1, 1].
[[nodiscard]] inline bool crank_angle(const Platform3rrsGeometry& geometry, double x, double y,
                                      CrankAngle& crank) {
  const double a = geometry.crank;
  const double b = geometry.coupler;
  const double L2 = x * x + y * y;
  const double L = std::sqrt(L2);
  const double difference = a * a - b * b;
  // Law of cosines at the base joint.
  const double cosine =
      L > 0.0 ? (L + difference / L) / (2.0 * a) : (difference > 0.0 ? 2.0 : -2.0);
  crank.angle = std::atan2(y, x) - std::acos(std::clamp(cosine, -1.0, 1.0));
  const double sine2 = 1.0 - cosine * cosine;
  if (!(sine2 >= 0.0) || !(L > 0.0)) return false;
  const double sine = std::sqrt(std::max(sine2, 1e-18));
  const double c1 = (1.0 - difference / L2) / (2.0 * a);  // d cosine / dL
  const double c2 = difference / (a * L2 * L);
  const double arc1 = -c1 / sine;  // d acos / dL
  const double arc2 = -c2 / sine - cosine * c1 * c1 / (sine * sine * sine);
  const double lx = x / L;
  const double ly = y / L;
  crank.dx = -ly / L - arc1 * lx;
  crank.dy = lx / L - arc1 * ly;
  crank.dxx = 2.0 * lx * ly / L2 - arc2 * lx * lx - arc1 * ly * ly / L;
  crank.dxy = (ly * ly - lx * lx) / L2 - arc2 * lx * ly + arc1 * lx * ly / L;
  crank.dyy = -2.0 * lx * ly / L2 - arc2 * ly * ly - arc1 * lx * lx / L;
  return true;
}

}  // namespace softfinger
