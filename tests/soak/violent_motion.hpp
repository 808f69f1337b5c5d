#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "softfinger/geometry/trajectory.hpp"

namespace softfinger {

/// A tracked pose that jumps at random every 48 ms, by at most 20 mm and 45 degrees, around the
/// waypoints of an exploration: the finger is driven into the objects, along them and off them as
/// no hand could. The same seed gives the same motion.
class ViolentMotion {
 public:
  /// `around`: at least one waypoint.
  ViolentMotion(std::vector<Waypoint> around, std::uint64_t seed);
  /// X_WFt at a time that never decreases, s.
  [[nodiscard]] const Pose& sample(double time);

 private:
  void jump();
  /// Uniform in [-1, 1); the standard distributions differ between libraries.
  double uniform();
  /// Uniform in the ball of radius 1.
  Vector3 in_ball();

  std::vector<Waypoint> around_;
  std::mt19937_64 random_;
  std::size_t jumps_ = 0;
  double next_jump_;
  Pose X_WFt_;
};

}  // namespace softfinger
