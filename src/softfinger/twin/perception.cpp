#include "softfinger/twin/perception.hpp"

#include <algorithm>
#include <array>

#include "softfinger/base/units.hpp"

namespace softfinger {

std::span<const PerceptionThreshold> perception_thresholds() {
  static constexpr std::array<PerceptionThreshold, 4> kThresholds{{
      {"centroid_shift_mm", 0.87 * mm, "least gap felt by a resting fingertip",
       "Johnson and Phillips 1981, J. Neurophysiology 46"},
      {"normal_angle_deg", 7.1 * deg, "least difference felt in the direction of a force",
       "Panarese and Edin 2011, J. Neurophysiology 105"},
      {"normal_force_error", 0.10, "just noticeable difference of forces above 0.5 N, 7 to 10 %",
       "Scientific Reports 2022, 10.1038/s41598-022-12010-0"},
      {"contact_area_error", 0.15,
       "Weber fraction of stiffness told by surface deformation; for area itself none is known",
       "Bergmann Tiest and Kappers 2009, IEEE Trans. Haptics 2"},
  }};
  return kThresholds;
}

const PerceptionThreshold* perception_threshold(std::string_view measure) {
  const auto thresholds = perception_thresholds();
  const auto found = std::find_if(thresholds.begin(), thresholds.end(),
                                  [&](const auto& t) { return t.measure == measure; });
  return found == thresholds.end() ? nullptr : &*found;
}

}  // namespace softfinger
