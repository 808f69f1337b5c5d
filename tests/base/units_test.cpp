#include "softfinger/base/units.hpp"

#include <gtest/gtest.h>

#include <array>

#include "softfinger/base/unit_words.hpp"

namespace softfinger {
namespace {

struct Case {
  std::string_view key;
  double scale;
  std::string_view words;
  std::string_view symbol;
};

// Written out from what the units are; suffixes of several words end in others.
constexpr std::array kCases{
    Case{"radius_mm", 1e-3, "mm", "mm"},
    Case{"area_mm2", 1e-6, "square millimetres", "mm2"},
    Case{"pitch_deg", 0.017453292519943295, "degrees", "deg"},
    Case{"joint_rate_deg_per_s", 0.017453292519943295, "degrees per second", "deg/s"},
    Case{"translation_N_per_mm", 1e3, "N per mm", "N/mm"},
    Case{"rotation_N_mm_per_rad", 1e-3, "N mm per radian", "N mm/rad"},
    Case{"torque_N_mm", 1e-3, "N mm", "N mm"},
    Case{"compliance_deg_per_N_mm", 17.453292519943295, "degrees per N mm", "deg/(N mm)"},
    Case{"compliance_mm_per_N", 1e-3, "mm per N", "mm/N"},
    Case{"gravity_m_per_s2", 1.0, "metres per second squared", "m/s2"},
    Case{"max_force_N", 1.0, "N", "N"},
    Case{"us_per_deg", 1e-6 / 0.017453292519943295, "microseconds per degree", "us/deg"},
    Case{"count", 1.0, "", ""},
};

TEST(Units, OfAKeyAreThoseOfItsWholeSuffix) {
  for (const Case& each : kCases) {
    EXPECT_NEAR(unit_scale(each.key), each.scale, 1e-12 * each.scale) << each.key;
    EXPECT_EQ(unit_words(each.key), each.words);
    EXPECT_EQ(unit_symbol(each.key), each.symbol);
  }
}

}  // namespace
}  // namespace softfinger
