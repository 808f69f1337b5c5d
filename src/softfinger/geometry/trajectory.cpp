#include "softfinger/geometry/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "softfinger/base/error.hpp"

namespace softfinger {

namespace {

/// The rotation vector of the same rotation that is nearest to `previous`.
Vector3 unwrapped(const Vector3& vector, const Vector3& previous) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  // A rotation by nothing is one by full turns about any axis.
  const Vector3 axis = vector.norm() > 1e-9 ? vector.normalized() : previous.normalized();
  return vector + kTurn * std::round((previous - vector).dot(axis) / kTurn) * axis;
}

/// d exp(v) / dt = skew(J dv/dt) exp(v): the left Jacobian of the rotation group.
Matrix3 left_jacobian(const Vector3& v) {
  const double angle2 = v.squaredNorm();
  const double angle = std::sqrt(angle2);
  const bool small = angle < 1e-3;
  const double a = small ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
  const double b =
      small ? 1.0 / 6.0 - angle2 / 120.0 : (angle - std::sin(angle)) / (angle2 * angle);
  const Matrix3 w = skew(v);
  return Matrix3::Identity() + a * w + b * w * w;
}

/// Velocity at a waypoint between slopes, both at least 0, before and after.
double waypoint_velocity(double slope_before, double time_before, double slope_after,
                         double time_after) {
  const double parabola =
      (time_after * slope_before + time_before * slope_after) / (time_before + time_after);
  return std::min(parabola, 2.0 * std::min(slope_before, slope_after));
}

/// The same for a coordinate of any sign.
double turning_velocity(double slope_before, double time_before, double slope_after,
                        double time_after) {
  if (slope_before * slope_after <= 0.0) return 0.0;
  return std::copysign(
      waypoint_velocity(std::abs(slope_before), time_before, std::abs(slope_after), time_after),
      slope_before);
}

/// The same for a position: depends on lengths and the angle between the slopes alone, so that it
/// turns with the scene.
Vector3 moving_velocity(const Vector3& slope_before, double time_before, const Vector3& slope_after,
                        double time_after) {
  const double before = slope_before.norm();
  const double after = slope_after.norm();
  if (!(before > 0.0) || !(after > 0.0)) return Vector3::Zero();
  // Half the angle, by way of its sine and cosine: a cosine alone is blind near zero.
  const Vector3 middle = slope_before / before + slope_after / after;
  const Vector3 across = slope_before / before - slope_after / after;
  const double bend = 2.0 * std::atan2(across.norm(), middle.norm());
  if (bend >= Trajectory::kCorner) return Vector3::Zero();
  const double share = 1.0 - (bend / Trajectory::kCorner) * (bend / Trajectory::kCorner);
  return share * waypoint_velocity(before, time_before, after, time_after) * middle.normalized();
}

}  // namespace

Trajectory::Trajectory(const Pose& fixed) : waypoints_{{.time = 0.0, .pose = fixed}} {}

Trajectory::Trajectory(std::vector<Waypoint> waypoints) : waypoints_(std::move(waypoints)) {
  if (waypoints_.empty()) throw InputError("a motion needs at least one waypoint");
  const std::size_t count = waypoints_.size();
  std::vector<Coordinates> values(count);
  const Matrix3& R_WR = waypoints_.front().pose.rotation;  // R: the rotations' reference
  for (std::size_t i = 0; i < count; ++i) {
    const Pose& pose = waypoints_[i].pose;
    Vector3 turn = Vector3::Zero();
    if (i > 0) {
      const Vector3 last = values[i - 1].tail<3>();
      // Copied where nothing turns, so that rounding does not disturb a dwell.
      turn = pose.rotation == waypoints_[i - 1].pose.rotation
                 ? last
                 : unwrapped(log_rotation(R_WR.transpose() * pose.rotation), last);
    }
    values[i] << pose.translation, turn;
  }
  segments_.resize(count - 1);
  std::vector<Coordinates> slopes(count - 1);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    segments_[i].duration = waypoints_[i + 1].time - waypoints_[i].time;
    if (!(segments_[i].duration > 0.0)) {
      throw InputError("the times of waypoints must increase strictly");
    }
    slopes[i] = (values[i + 1] - values[i]) / segments_[i].duration;
  }
  std::vector<Coordinates> velocities(count, Coordinates::Zero());
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double before = segments_[i - 1].duration;
    const double after = segments_[i].duration;
    velocities[i].head<3>() =
        moving_velocity(slopes[i - 1].head<3>(), before, slopes[i].head<3>(), after);
    for (int k = 3; k < 6; ++k) {
      velocities[i][k] = turning_velocity(slopes[i - 1][k], before, slopes[i][k], after);
    }
  }
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const Coordinates change = values[i + 1] - values[i];
    const Coordinates begin = velocities[i] * segments_[i].duration;
    const Coordinates end = velocities[i + 1] * segments_[i].duration;
    auto& c = segments_[i].coefficients;
    c.col(0) = values[i];
    c.col(1) = begin;
    c.col(2).setZero();
    c.col(3) = 10.0 * change - 6.0 * begin - 4.0 * end;
    c.col(4) = -15.0 * change + 8.0 * begin + 7.0 * end;
    c.col(5) = 6.0 * change - 3.0 * begin - 3.0 * end;
  }
}

void Trajectory::hold(const Pose& fixed) {
  segments_.clear();
  waypoints_.resize(1);  // there is one at least
  waypoints_.front() = {.time = 0.0, .pose = fixed};
}

Pose Trajectory::sample(double time) const { return sample_motion(time).pose; }

PoseMotion Trajectory::sample_motion(double time) const {
  // Written so that a time that is not a number counts as the start.
  if (!(time > waypoints_.front().time)) return {.pose = waypoints_.front().pose};
  if (time >= waypoints_.back().time) return {.pose = waypoints_.back().pose};
  const auto after = std::upper_bound(waypoints_.begin(), waypoints_.end(), time,
                                      [](double t, const Waypoint& w) { return t < w.time; });
  const auto index = static_cast<std::size_t>(after - waypoints_.begin()) - 1;
  const Segment& segment = segments_[index];
  const double s = (time - waypoints_[index].time) / segment.duration;
  Coordinates value = segment.coefficients.col(5);
  Coordinates rate = Coordinates::Zero();
  for (int k = 4; k >= 0; --k) {
    rate = (rate * s + value).eval();
    value = (value * s + segment.coefficients.col(k)).eval();
  }
  rate /= segment.duration;
  const Matrix3& R_WR = waypoints_.front().pose.rotation;
  const Vector3 turn = value.tail<3>();
  return {.pose = {.rotation = R_WR * exp_rotation(turn), .translation = value.head<3>()},
          .velocity = rate.head<3>(),
          .angular_velocity = R_WR * (left_jacobian(turn) * rate.tail<3>())};
}

double Trajectory::start_time() const { return waypoints_.front().time; }

double Trajectory::end_time() const { return waypoints_.back().time; }

bool Trajectory::moves() const {
  const Pose& first = waypoints_.front().pose;
  return std::ranges::any_of(waypoints_, [&](const Waypoint& w) {
    return w.pose.translation != first.translation || w.pose.rotation != first.rotation;
  });
}

}  // namespace softfinger
