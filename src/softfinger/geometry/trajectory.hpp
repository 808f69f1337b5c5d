#pragma once

#include <vector>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// A pose to be at, at a time (s).
struct Waypoint {
  double time = 0.0;
  Pose pose;
};

/// Pose and its rates at one time. velocity in m/s; angular_velocity in rad/s; both in the parent
/// frame of the pose.
struct PoseMotion {
  Pose pose;
  Vector3 velocity = Vector3::Zero();
  Vector3 angular_velocity = Vector3::Zero();
};

/// A motion through waypoints, twice continuously differentiable in position and on rotations, at
/// rest at both ends and held before the first and after the last.
class Trajectory {
 public:
  /// One fixed pose for all time.
  explicit Trajectory(const Pose& fixed = {});
  /// Waypoints with strictly increasing times, at least one.
  explicit Trajectory(std::vector<Waypoint> waypoints);

  [[nodiscard]] Pose sample(double time) const;
  [[nodiscard]] PoseMotion sample_motion(double time) const;
  [[nodiscard]] double start_time() const;
  [[nodiscard]] double end_time() const;
  [[nodiscard]] bool moves() const;

 private:
  std::vector<Waypoint> waypoints_;
  // Added by the implementation: spline coefficients.
};

}  // namespace softfinger
