#pragma once

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Keeps glitches out of a stream of poses: what is farther from the last pose let through than a
/// hand gets in the time between is left out, as if it had not come. The majority is right: when so
/// many more were left out than let through, the next that would be left out is let through, and
/// those around it.
class JumpGate {
 public:
  /// `now`: s, when the pose came, never decreasing.
  [[nodiscard]] bool admits(const Pose& X_WFt, double now);

  /// Faster than hands reach for something; and what noise may add.
  static constexpr double kMostSpeed = 5.0;      ///< m/s
  static constexpr double kMostNoise = 0.03;     ///< m
  static constexpr double kMostTurnRate = 60.0;  ///< rad/s
  static constexpr double kMostTurnNoise = 0.5;  ///< rad
  static constexpr int kMajority = 12;           ///< poses, 0.1 s of most trackers

 private:
  [[nodiscard]] bool within_reach(const Pose& X_WFt, double now) const;

  bool known_ = false;
  Pose last_;
  double admitted_ = 0.0;
  int doubt_ = 0;  ///< how many more were left out than let through
};

}  // namespace softfinger
