#include "softfinger/base/units.hpp"

#include <array>
#include <utility>

namespace softfinger {

double unit_scale(std::string_view key) {
  // Longer suffixes first: "_N_per_mm" ends in "_mm" as well.
  static constexpr std::array<std::pair<std::string_view, double>, 27> kSuffixes{{
      {"_N_mm_s_per_rad", 1e-3},
      {"_N_mm_per_rad", 1e-3},
      {"_N_s_per_mm", 1e3},
      {"_N_per_mm", 1e3},
      {"_kg_per_m3", 1.0},
      {"_us_per_deg", us / deg},
      {"_us_per_mm", us / mm},
      {"_per_deg", 1.0 / deg},
      {"_per_mm", 1.0 / mm},
      {"_deg_per_s2", deg},
      {"_mm_per_s2", mm},
      {"_deg_per_s", deg},
      {"_mm_per_s", mm},
      {"_mm2", mm2},
      {"_deg", deg},
      {"_rad", 1.0},
      {"_kPa", kPa},
      {"_mm", mm},
      {"_ms", ms},
      {"_us", us},
      {"_kg", 1.0},
      {"_Hz", 1.0},
      {"_N", 1.0},
      {"_g", 1e-3},
      {"_m", 1.0},
      {"_s", 1.0},
      {"", 1.0},
  }};
  for (const auto& [suffix, scale] : kSuffixes) {
    // A key may be nothing but its unit: "us_per_deg".
    if (key.ends_with(suffix) || key == suffix.substr(suffix.empty() ? 0 : 1)) return scale;
  }
  return 1.0;
}

}  // namespace softfinger
