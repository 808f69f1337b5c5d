#pragma once

#include <array>

#include "softfinger/device/platform_3rrs.hpp"
#include "softfinger/device/tilt.hpp"

namespace softfinger {

/// Cosine and sine of the legs' azimuths 0, 120, 240 degrees.
inline constexpr std::array<double, 3> kLegCosine{1.0, -0.5, -0.5};
inline constexpr std::array<double, 3> kLegSine{0.0, 0.86602540378443864676,
                                                -0.86602540378443864676};

/// Platform joint of one leg in the leg's plane, relative to the base joint: x outward, y towards
/// the platform; m. Functions of pitch and roll; dx/dtravel = 0, dy/dtravel = -1.
struct LegPosture {
  PlaneFunction x, y;
};

[[nodiscard]] LegPosture leg_posture(const Platform3rrsGeometry& geometry, const Tilt& tilt,
                                     double travel, int leg);

/// Centre of the platform in B' with derivatives by pitch and roll; z is travel.
struct PlatformCentre {
  PlaneFunction x, y;
};
[[nodiscard]] PlatformCentre platform_centre(const Platform3rrsGeometry& geometry,
                                             const Tilt& tilt);

/// The crank angle, knee outward, for the platform joint at (x, y), with derivatives by x and y.
struct CrankAngle {
  double angle = 0.0;
  double dx = 0.0, dy = 0.0;
  double dxx = 0.0, dxy = 0.0, dyy = 0.0;
};
/// False where crank and coupler do not reach (x, y), or only just: then only `angle` may be used,
/// with the arccosine's argument cut to [-1, 1].
[[nodiscard]] bool crank_angle(const Platform3rrsGeometry& geometry, double x, double y,
                               CrankAngle& crank);

}  // namespace softfinger
