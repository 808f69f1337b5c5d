#pragma once

#include <vector>

#include "softfinger/base/units.hpp"
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
///
/// Each coordinate is a quintic Hermite polynomial per segment, without acceleration at the
/// waypoints. The speed there is that of the parabola through the lengths of three waypoints, cut
/// to twice the smaller of the neighbouring slopes (after Fritsch and Butland 1984 for cubics), and
/// falls to zero as the way bends, at kCorner: so the position goes straight from waypoint to
/// waypoint and rests at corners, and where the way bends by less it strays from the straight line
/// by at most 1 % of its length. That holds for any choice of axes: a turned, moved or mirrored
/// list of waypoints gives the turned, moved or mirrored motion. Two equal waypoints are an exact
/// dwell, and a waypoint influences only the two segments on either side. Rotations are
/// interpolated as rotation vectors relative to the first waypoint's, each taken on the turn
/// nearest to the one before, coordinate by coordinate with the same speeds, zero where a
/// coordinate turns back; none leaves the range of the two waypoints around it.
class Trajectory {
 public:
  /// A way that bends by this much or more at a waypoint stops there, rad.
  static constexpr double kCorner = 5.0 * deg;

  /// One fixed pose for all time.
  explicit Trajectory(const Pose& fixed = {});
  /// Waypoints with strictly increasing times, at least one; else throws InputError.
  explicit Trajectory(std::vector<Waypoint> waypoints);

  /// From here on one fixed pose. Allocates nothing.
  void hold(const Pose& fixed);

  /// Allocates nothing.
  [[nodiscard]] Pose sample(double time) const;
  /// Pose and its exact derivatives. Allocates nothing.
  [[nodiscard]] PoseMotion sample_motion(double time) const;
  [[nodiscard]] double start_time() const;
  [[nodiscard]] double end_time() const;
  /// Whether any two waypoints differ.
  [[nodiscard]] bool moves() const;
  [[nodiscard]] const std::vector<Waypoint>& waypoints() const { return waypoints_; }

 private:
  /// Translation (m), then rotation vector (rad) relative to the first waypoint.
  using Coordinates = Eigen::Matrix<double, 6, 1>;
  /// From one waypoint to the next: column k multiplies ((time - start) / duration)^k.
  struct Segment {
    double duration = 0.0;
    Eigen::Matrix<double, 6, 6> coefficients;
  };

  std::vector<Waypoint> waypoints_;
  std::vector<Segment> segments_;  ///< one fewer than waypoints
};

}  // namespace softfinger
