#include "softfinger/base/units.hpp"
#include "softfinger/base/unit_words.hpp"

#include <array>

namespace softfinger {

namespace {

struct Unit {
  std::string_view suffix;
  double scale;
  std::string_view words;
  std::string_view symbol;
};

const Unit& unit_of(std::string_view key) {
  // Longer suffixes first: "_N_per_mm" ends in "_mm" as well.
  static constexpr std::array kUnits{
      Unit{"_N_mm_s_per_rad", 1e-3, "N mm s per radian", "N mm s/rad"},
      Unit{"_N_mm_per_rad", 1e-3, "N mm per radian", "N mm/rad"},
      Unit{"_N_s_per_mm", 1e3, "N s per mm", "N s/mm"},
      Unit{"_N_per_mm", 1e3, "N per mm", "N/mm"},
      Unit{"_deg_per_N_mm", deg / 1e-3, "degrees per N mm", "deg/(N mm)"},
      Unit{"_mm_per_N", mm, "mm per N", "mm/N"},
      Unit{"_N_mm", 1e-3, "N mm", "N mm"},
      Unit{"_N_s", 1.0, "N s", "N s"},
      Unit{"_kg_per_m3", 1.0, "kg per cubic metre", "kg/m3"},
      Unit{"_us_per_deg", us / deg, "microseconds per degree", "us/deg"},
      Unit{"_us_per_mm", us / mm, "microseconds per mm", "us/mm"},
      Unit{"_per_deg", 1.0 / deg, "per degree", "1/deg"},
      Unit{"_per_mm", 1.0 / mm, "per mm", "1/mm"},
      Unit{"_m_per_s2", 1.0, "metres per second squared", "m/s2"},
      Unit{"_deg_per_s2", deg, "degrees per second squared", "deg/s2"},
      Unit{"_mm_per_s2", mm, "mm per second squared", "mm/s2"},
      Unit{"_deg_per_s", deg, "degrees per second", "deg/s"},
      Unit{"_mm_per_s", mm, "mm per second", "mm/s"},
      Unit{"_mm2", mm2, "square millimetres", "mm2"},
      Unit{"_deg", deg, "degrees", "deg"},
      Unit{"_rad", 1.0, "radians", "rad"},
      Unit{"_kPa", kPa, "kPa", "kPa"},
      Unit{"_mm", mm, "mm", "mm"},
      Unit{"_ms", ms, "milliseconds", "ms"},
      Unit{"_us", us, "microseconds", "us"},
      Unit{"_kg", 1.0, "kg", "kg"},
      Unit{"_Hz", 1.0, "Hz", "Hz"},
      Unit{"_N", 1.0, "N", "N"},
      Unit{"_g", 1e-3, "grams", "g"},
      Unit{"_m", 1.0, "metres", "m"},
      Unit{"_s", 1.0, "seconds", "s"},
      Unit{"", 1.0, "", ""},
  };
  for (const Unit& unit : kUnits) {
    // A key may be nothing but its unit: "us_per_deg".
    if (key.ends_with(unit.suffix) || key == unit.suffix.substr(unit.suffix.empty() ? 0 : 1)) {
      return unit;
    }
  }
  return kUnits.back();
}

}  // namespace

double unit_scale(std::string_view key) { return unit_of(key).scale; }

std::string_view unit_words(std::string_view key) { return unit_of(key).words; }

std::string_view unit_symbol(std::string_view key) { return unit_of(key).symbol; }

}  // namespace softfinger
