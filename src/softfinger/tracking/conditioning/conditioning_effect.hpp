#pragma once

#include <functional>

#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"
#include "softfinger/tracking/conditioning/degraded_tracker.hpp"

namespace softfinger {

/// How far poses are from the truth: roots of mean squares.
struct PoseError {
  double distance = 0.0;  ///< m
  double turn = 0.0;      ///< rad
};

struct ConditioningEffect {
  struct Part {
    double time = 0.0;  ///< s, how long the motion was like that
    PoseError before;   ///< of poses as they come
    PoseError after;    ///< of conditioned ones
  };
  Part resting;  ///< slower than kRestSpeed and kRestTurnRate
  Part moving;

  static constexpr double kRestSpeed = 5e-3;     ///< m/s
  static constexpr double kRestTurnRate = 0.09;  ///< rad/s
};

/// What conditioning makes of a known motion of `duration` (s) that a tracking system sees, looked
/// at a thousand times a second. The truth is where the finger is when the poses take effect: by
/// the conditioning's lead later than they are sampled.
[[nodiscard]] ConditioningEffect conditioning_effect(const DegradedTracker::Motion& motion,
                                                     double duration,
                                                     const TrackingQuality& quality,
                                                     const PoseConditioning& conditioning);

}  // namespace softfinger
