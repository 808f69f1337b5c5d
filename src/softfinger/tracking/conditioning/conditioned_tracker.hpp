#pragma once

#include <memory>
#include <optional>
#include <string>

#include "softfinger/tracking/conditioning/one_euro_filter.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// What is done to tracked poses before the loop gets them; nothing by default.
struct PoseConditioning {
  std::optional<OneEuroSettings> filter;
  /// Poses are carried on, at the velocity they have, over their age and this time more, s: what
  /// the way from here to the motors takes. 0 to kMostLead; empty: no prediction.
  std::optional<double> lead;

  [[nodiscard]] bool changes_poses() const { return filter || lead; }

  static constexpr double kMostLead = 0.05;  ///< s
  /// Farther than this no pose is carried on, s.
  static constexpr double kFarthest = 0.1;
};

/// A tracker whose poses are filtered, predicted or both. What comes out is what the loop takes
/// and what a recording has, so that a replay needs to know nothing of it.
class ConditionedTracker final : public Tracker {
 public:
  ConditionedTracker(std::unique_ptr<Tracker> source, const PoseConditioning& conditioning);

  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return source_->end_time(); }
  [[nodiscard]] std::optional<std::string> take_message() override {
    return source_->take_message();
  }

 private:
  void take(const TrackedPose& pose);
  [[nodiscard]] Pose predicted(double ahead) const;

  std::unique_ptr<Tracker> source_;
  PoseConditioning conditioning_;
  OneEuroFilter filter_;
  TrackedPose newest_;                      ///< as it came; not valid: none
  Pose X_WFt_;                              ///< of it, filtered
  Vector3 velocity_W_ = Vector3::Zero();    ///< m/s
  Vector3 turn_rate_Ft_ = Vector3::Zero();  ///< rad/s
};

/// `source` as the loop samples it: conditioned where that changes anything, and, where its poses
/// are `sent` now and then, played evenly in between (InterpolatedTracker) unless prediction
/// carries them on.
[[nodiscard]] std::unique_ptr<Tracker> conditioned(std::unique_ptr<Tracker> source,
                                                   const PoseConditioning& conditioning, bool sent);

/// What that makes of poses, for who reads a recording: "interpolated", "filtered, interpolated",
/// "carried on by 20 ms"; empty: they are as they came.
[[nodiscard]] std::string conditioning_text(const PoseConditioning& conditioning, bool sent);

}  // namespace softfinger
