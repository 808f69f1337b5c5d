#pragma once

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Of a OneEuroFilter: low cutoffs still what trembles, high ones lag less.
struct OneEuroSettings {
  double min_cutoff = 4.0;      ///< at rest, Hz; above 0
  double per_speed = 1000.0;    ///< what a metre a second adds, Hz s/m; at least 0
  double per_turn_rate = 20.0;  ///< what a radian a second adds, Hz s/rad; at least 0
  double speed_cutoff = 5.0;    ///< of the speed itself, Hz; above 0
};

/// Smooths a noisy pose by a low-pass filter that opens with speed: little jitter at rest, little
/// lag in motion. Casiez, Roussel and Vogel, "1 Euro Filter: A Simple Speed-based Low-pass Filter
/// for Noisy Input in Interactive Systems" (CHI 2012), equations 3 to 7, on the position and on the
/// rotation as one turn each. Allocates nothing.
class OneEuroFilter {
 public:
  explicit OneEuroFilter(const OneEuroSettings& settings) : settings_(settings) {}

  /// Starts anew at this pose, at rest.
  void reset(const Pose& pose);
  /// The next pose, dt (s, above 0) after the one before; returns it smoothed.
  const Pose& update(const Pose& pose, double dt);

 private:
  OneEuroSettings settings_;
  Pose last_;  ///< as it came
  Pose smoothed_;
  Vector3 velocity_ = Vector3::Zero();   ///< m/s
  Vector3 turn_rate_ = Vector3::Zero();  ///< rad/s, in the body
};

}  // namespace softfinger
