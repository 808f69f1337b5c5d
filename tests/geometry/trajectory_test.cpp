#include "softfinger/geometry/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

Waypoint waypoint(double time, const Vector3& position, const Vector3& rotation_vector) {
  return {time, {exp_rotation(rotation_vector), position}};
}

std::vector<Waypoint> random_waypoints(unsigned seed, double largest_turn) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<Waypoint> waypoints;
  double time = 0.3;
  for (int i = 0; i < 12; ++i) {
    const Vector3 position(value(generator), value(generator), value(generator));
    const Vector3 turn(value(generator), value(generator), value(generator));
    waypoints.push_back(waypoint(time, 0.05 * position, largest_turn * turn));
    time += 0.6 + 0.5 * value(generator);
  }
  return waypoints;
}

double difference(const Pose& a, const Pose& b) {
  return (a.translation - b.translation).norm() + (a.rotation - b.rotation).norm();
}

TEST(Trajectory, PassesThroughItsWaypoints) {
  for (const double largest_turn : {0.3, 1.5, 3.0}) {
    const auto waypoints = random_waypoints(1, largest_turn);
    const Trajectory trajectory(waypoints);
    for (const Waypoint& w : waypoints) {
      EXPECT_LT(difference(trajectory.sample(w.time), w.pose), 1e-12);
    }
    EXPECT_DOUBLE_EQ(trajectory.start_time(), waypoints.front().time);
    EXPECT_DOUBLE_EQ(trajectory.end_time(), waypoints.back().time);
    EXPECT_TRUE(trajectory.moves());
  }
}

TEST(Trajectory, VelocitiesAreTheDerivatives) {
  const Trajectory trajectory(random_waypoints(2, 1.5));
  const double h = 1e-6;
  for (double t = 0.31; t < trajectory.end_time(); t += 0.0173) {
    const PoseMotion motion = trajectory.sample_motion(t);
    const Pose before = trajectory.sample(t - h);
    const Pose after = trajectory.sample(t + h);
    EXPECT_LT(((after.translation - before.translation) / (2 * h) - motion.velocity).norm(), 1e-7);
    const Vector3 turned = log_rotation(after.rotation * before.rotation.transpose()) / (2 * h);
    EXPECT_LT((turned - motion.angular_velocity).norm(), 1e-6);
    const Matrix3 product = motion.pose.rotation.transpose() * motion.pose.rotation;
    EXPECT_LT((product - Matrix3::Identity()).norm(), 1e-12);
  }
}

// Across every waypoint, and across both ends: the jump of the second derivative over an interval
// shrinks with the interval.
TEST(Trajectory, IsTwiceContinuouslyDifferentiable) {
  for (const double largest_turn : {0.5, 3.0}) {
    const Trajectory trajectory(random_waypoints(3, largest_turn));
    const auto acceleration = [&](double t) {
      const double h = 1e-5;
      const PoseMotion a = trajectory.sample_motion(t - h);
      const PoseMotion b = trajectory.sample_motion(t + h);
      Eigen::Matrix<double, 6, 1> value;
      value << (b.velocity - a.velocity), (b.angular_velocity - a.angular_velocity);
      return (value / (2 * h)).eval();
    };
    for (const Waypoint& w : trajectory.waypoints()) {
      const double wide = (acceleration(w.time + 1e-2) - acceleration(w.time - 1e-2)).norm();
      const double narrow = (acceleration(w.time + 1e-4) - acceleration(w.time - 1e-4)).norm();
      EXPECT_LT(narrow, 0.05 * wide + 1e-6) << w.time;
      const PoseMotion before = trajectory.sample_motion(w.time - 1e-9);
      const PoseMotion after = trajectory.sample_motion(w.time + 1e-9);
      EXPECT_LT((before.velocity - after.velocity).norm(), 1e-6);
      EXPECT_LT((before.angular_velocity - after.angular_velocity).norm(), 1e-5);
    }
  }
}

TEST(Trajectory, RestsAtBothEndsAndIsHeldOutside) {
  const Trajectory trajectory(random_waypoints(4, 1.0));
  for (const double t : {-1.0, 0.0, 0.3, trajectory.end_time(), trajectory.end_time() + 5.0}) {
    const PoseMotion motion = trajectory.sample_motion(t);
    const Waypoint& end = t < 1.0 ? trajectory.waypoints().front() : trajectory.waypoints().back();
    EXPECT_EQ(difference(motion.pose, end.pose), 0.0);
    EXPECT_TRUE(motion.velocity.isZero(0.0));
    EXPECT_TRUE(motion.angular_velocity.isZero(0.0));
  }
}

/// Very unequal steps in time, where ordinary splines swing.
std::vector<Waypoint> unevenly_timed(std::vector<Waypoint> waypoints) {
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    waypoints[i].time = static_cast<double>(i) + (i % 2 == 0 ? 0.0 : 0.95);
  }
  return waypoints;
}

// Along no direction, not only those of the axes.
TEST(Trajectory, NeverOvershoots) {
  const auto waypoints = unevenly_timed(random_waypoints(5, 0.0));
  const Trajectory trajectory(waypoints);
  for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
    const Vector3& a = waypoints[i].pose.translation;
    const Vector3 way = waypoints[i + 1].pose.translation - a;
    double last = 0.0;
    for (int k = 0; k <= 200; ++k) {
      const double s = k / 200.0;
      const Vector3 from_a =
          trajectory.sample((1 - s) * waypoints[i].time + s * waypoints[i + 1].time).translation -
          a;
      const double done = from_a.dot(way) / way.squaredNorm();
      EXPECT_GE(done, last - 1e-12);
      EXPECT_LE(done, 1.0 + 1e-12);
      EXPECT_LT((from_a - done * way).norm(), 1e-12);
      last = done;
    }
  }
}

// Slight bends are taken without a halt, whatever the times, and hardly leave the straight line.
TEST(Trajectory, TakesSlightBendsInOneGo) {
  for (const double bend : {0.0, 0.5, 2.0, 2.9, 4.0, 4.99}) {
    std::vector<Waypoint> waypoints(7);
    double heading = 0.0;
    for (std::size_t i = 1; i < waypoints.size(); ++i) {
      waypoints[i].pose.translation =
          waypoints[i - 1].pose.translation +
          (i % 3 == 0 ? 2.0 : 8.0) * mm * Vector3(std::cos(heading), std::sin(heading), 0.0);
      heading += (i % 2 == 0 ? -2.0 : 1.0) * bend * deg / (i % 2 == 0 ? 2.0 : 1.0);
    }
    waypoints = unevenly_timed(waypoints);
    const Trajectory trajectory(waypoints);
    for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
      if (i > 0) {
        EXPECT_GT(trajectory.sample_motion(waypoints[i].time).velocity.norm(), 0.0) << bend;
      }
      const Vector3& a = waypoints[i].pose.translation;
      const Vector3 way = waypoints[i + 1].pose.translation - a;
      for (int k = 0; k <= 100; ++k) {
        const double s = k / 100.0;
        const Vector3 p =
            trajectory.sample((1 - s) * waypoints[i].time + s * waypoints[i + 1].time).translation;
        EXPECT_LT((p - a).cross(way).norm(), 0.01 * way.squaredNorm() + 1e-15) << bend;
      }
    }
  }
}

// Turned, shifted, mirrored waypoints: the turned, shifted, mirrored motion, to rounding.
TEST(Trajectory, DoesNotDependOnTheWorldsAxes) {
  for (unsigned seed = 10; seed < 20; ++seed) {
    auto waypoints = random_waypoints(seed, 1.0);
    waypoints[4].pose = waypoints[3].pose;  // a dwell
    // Straight on, and nearly.
    waypoints[7].pose.translation =
        2.0 * waypoints[6].pose.translation - waypoints[5].pose.translation;
    waypoints[8].pose.translation = 2.0 * waypoints[7].pose.translation -
                                    waypoints[6].pose.translation + Vector3(0.0, 4e-4, 0.0);
    const Pose turn{exp_rotation(random_waypoints(seed + 50, 3.0).front().pose.translation * 60.0),
                    {0.3, -0.2, 0.1}};
    const Matrix3 mirror = Vector3(1.0, -1.0, 1.0).asDiagonal();
    auto turned = waypoints;
    auto mirrored = waypoints;
    for (std::size_t i = 0; i < waypoints.size(); ++i) {
      turned[i].pose = turn * waypoints[i].pose;
      turned[i].time += 0.25;
      mirrored[i].pose = {mirror * waypoints[i].pose.rotation * mirror,
                          mirror * waypoints[i].pose.translation};
    }
    const Trajectory trajectory(waypoints), other(turned), reflection(mirrored);
    for (double t = 0.0; t < trajectory.end_time(); t += 0.0137) {
      const PoseMotion motion = trajectory.sample_motion(t);
      EXPECT_LT(difference(other.sample(t + 0.25), turn * motion.pose), 1e-12);
      EXPECT_LT((other.sample_motion(t + 0.25).velocity - turn.rotation * motion.velocity).norm(),
                1e-11);
      const Pose reflected = reflection.sample(t);
      EXPECT_LT(difference({mirror * reflected.rotation * mirror, mirror * reflected.translation},
                           motion.pose),
                1e-12);
    }
  }
}

TEST(Trajectory, EqualWaypointsAreAnExactDwell) {
  const Vector3 there(0.01, 0.02, -0.003);
  const Vector3 tilted(0.2, -0.3, 0.1);
  const Trajectory trajectory({waypoint(0.0, {0, 0, 0.04}, {0.4, 0.0, 0.0}),
                               waypoint(1.0, there, tilted), waypoint(2.0, there, tilted),
                               waypoint(2.5, {0.0, 0.0, 0.04}, {0.0, 0.5, 0.0})});
  for (double t = 1.0; t <= 2.0; t += 0.05) {
    const PoseMotion motion = trajectory.sample_motion(t);
    EXPECT_LT(difference(motion.pose, {exp_rotation(tilted), there}), 1e-14);
    EXPECT_TRUE(motion.velocity.isZero(0.0));
    EXPECT_TRUE(motion.angular_velocity.isZero(0.0));
  }
}

// 3.5 turns about one axis in steps below a half turn each: the speed stays that of the steps.
TEST(Trajectory, GoesOnTurningBeyondAHalfTurn) {
  std::vector<Waypoint> waypoints;
  const Vector3 axis = Vector3(1.0, 2.0, -0.5).normalized();
  for (int i = 0; i <= 14; ++i) {
    waypoints.push_back(waypoint(i, Vector3::Zero(), i * std::numbers::pi / 2 * axis));
  }
  const Trajectory trajectory(waypoints);
  for (double t = 1.0; t <= 13.0; t += 0.01) {
    const Vector3 rate = trajectory.sample_motion(t).angular_velocity;
    EXPECT_NEAR(rate.dot(axis), std::numbers::pi / 2, 1e-9);
    EXPECT_NEAR(rate.norm(), std::numbers::pi / 2, 1e-9);
  }
}

TEST(Trajectory, FixedPoseDoesNotMove) {
  const Pose pose{exp_rotation({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}};
  const Trajectory trajectory(pose);
  EXPECT_FALSE(trajectory.moves());
  EXPECT_EQ(difference(trajectory.sample(17.0), pose), 0.0);
  EXPECT_DOUBLE_EQ(trajectory.end_time(), 0.0);
  EXPECT_FALSE(Trajectory(std::vector<Waypoint>{{0.0, pose}, {1.0, pose}}).moves());
}

TEST(Trajectory, RefusesTimesThatDoNotIncrease) {
  EXPECT_THROW(Trajectory(std::vector<Waypoint>{}), InputError);
  EXPECT_THROW(Trajectory(std::vector<Waypoint>{{1.0, {}}, {1.0, {}}}), InputError);
  EXPECT_THROW(Trajectory(std::vector<Waypoint>{{1.0, {}}, {0.5, {}}}), InputError);
}

TEST(Trajectory, HoldsAPoseFromHereOn) {
  Trajectory trajectory(std::vector<Waypoint>{
      {.time = 0.0, .pose = {}}, {.time = 1.0, .pose = {Matrix3::Identity(), {1.0, 0.0, 0.0}}}});
  EXPECT_TRUE(trajectory.moves());
  const Pose there{Matrix3::Identity(), {0.0, 2.0, 0.0}};
  trajectory.hold(there);
  EXPECT_FALSE(trajectory.moves());
  for (const double time : {-1.0, 0.0, 0.5, 3.0}) {
    EXPECT_EQ(trajectory.sample(time).translation, there.translation);
    EXPECT_EQ(trajectory.sample_motion(time).velocity, Vector3::Zero());
  }
}

}  // namespace
}  // namespace softfinger
