#pragma once

#include <vector>

#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// Gives back, step by step and to the bit, what another tracker gave during a run.
class RecordedTracker final : public Tracker {
 public:
  /// `poses[k]` is what step k took, k from 0, at least one; time_step in s.
  RecordedTracker(std::vector<TrackedPose> poses, double time_step);
  /// The entry of the step nearest to `time`; the first before, the last after all.
  [[nodiscard]] TrackedPose sample(double time) override;
  /// Time of the last step.
  [[nodiscard]] std::optional<double> end_time() const override;

 private:
  std::vector<TrackedPose> poses_;
  double time_step_;
};

}  // namespace softfinger
