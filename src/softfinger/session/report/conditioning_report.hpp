#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "softfinger/tracking/conditioning/conditioning_effect.hpp"

namespace softfinger {

/// What is asked about conditioning a known motion.
struct ConditioningQuestion {
  std::filesystem::path motion;  ///< a recording, or a CSV file of poses: the truth
  std::string finger;            ///< of a recording of several; empty: the first
  /// What a tracking system makes of it: 120 poses a second, 15 ms old, noise of 0.1 mm and 0.2
  /// degrees unless said.
  TrackingQuality quality = usual_quality();
  bool filter = false;
  std::optional<double> predict;  ///< s, 0 to PoseConditioning::kMostLead

  [[nodiscard]] static TrackingQuality usual_quality();
};

/// Reads the motion and looks at it. Throws InputError for files and for what is out of range.
[[nodiscard]] ConditioningEffect conditioning_effect(const ConditioningQuestion& question);

/// The fields of `condition --json`.
nlohmann::ordered_json conditioning_report(const ConditioningEffect& effect);

}  // namespace softfinger
