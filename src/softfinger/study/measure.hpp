#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/base/name_table.hpp"
#include "softfinger/session/evaluation.hpp"
#include "softfinger/session/rendering_judge.hpp"

namespace softfinger {

/// How many numbers, of frames or of people, become one.
enum class Over {
  kMean,
  kP95,  ///< what 95 of 100 are no worse than, between two by a straight line
  kWorst
};
inline constexpr std::array<NameRow<Over>, 3> kOvers{{
    {Over::kMean, "mean"},
    {Over::kP95, "p95"},
    {Over::kWorst, "worst"},
}};

/// Numbers as one, where less is better, or more if `more_is_better`; NaN of none.
[[nodiscard]] double over(std::vector<double> values, Over how, bool more_is_better);

/// Names of what a study may measure: the numbers of `evaluate --json` that repeat. Those of
/// frames, "stress_error", "lagged.iou", "twin_force_N", and those of a run, "frames_missed".
[[nodiscard]] std::vector<std::string> measure_words();

/// What has to be looked at for these.
[[nodiscard]] JudgedSides sides_for(const std::vector<std::string>& measures);

/// Of each frame in which it is defined; of a run, one number. In the unit of the name.
[[nodiscard]] std::vector<double> measured(const Evaluation& evaluation, std::string_view measure);

}  // namespace softfinger
