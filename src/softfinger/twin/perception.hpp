#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "softfinger/twin/rendering_measures.hpp"

namespace softfinger {

/// What people notice of one measure.
struct PerceptionThreshold {
  std::string_view measure;  ///< a name of measure_names()
  double threshold;          ///< SI; less than this goes unnoticed
  std::string_view what;     ///< what was measured, in words
  std::string_view source;
};

/// Published thresholds for those measures that have one.
[[nodiscard]] std::span<const PerceptionThreshold> perception_thresholds();
/// The threshold of this measure, if there is one.
[[nodiscard]] const PerceptionThreshold* perception_threshold(std::string_view measure);

}  // namespace softfinger
