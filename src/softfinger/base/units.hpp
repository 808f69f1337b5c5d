#pragma once

#include <numbers>
#include <optional>
#include <string_view>

namespace softfinger {

// Inside the code every quantity is SI and radians; these convert at files, flags and wires.
inline constexpr double mm = 1e-3;
inline constexpr double mm2 = 1e-6;
inline constexpr double ms = 1e-3;
inline constexpr double us = 1e-6;
inline constexpr double deg = std::numbers::pi / 180.0;
inline constexpr double kPa = 1e3;

/// Factor from the unit named by the suffix of a key to SI, e.g. 1e-3 for "radius_mm", pi/180 for
/// "pitch_deg"; 1 for a key without a unit. Suffixes: _mm _mm2 _m _deg _rad _deg_per_s _deg_per_s2
/// _N _kPa _kg_per_m3 _g _kg _s _ms _us _Hz _mm_per_s _mm_per_s2 _m_per_s2 _N_per_mm _N_s_per_mm
/// _N_mm_per_rad _N_mm_s_per_rad _deg_per_N_mm _mm_per_N _N_mm _N_s _us_per_deg _us_per_mm _per_deg
/// _per_mm.
[[nodiscard]] double unit_scale(std::string_view key);

}  // namespace softfinger
