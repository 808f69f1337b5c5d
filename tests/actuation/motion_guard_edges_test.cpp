#include <gtest/gtest.h>

#include <limits>

#include "../support/lever_platform.hpp"
#include "softfinger/actuation/motion_guard.hpp"

namespace softfinger {
namespace {

constexpr double kEdgeTick = 1.0 / 30.0;
constexpr double kEdgeRate = 400.0 * deg;
constexpr double kEdgeAcceleration = kEdgeRate / 0.2;  ///< six ticks to full speed

Configuration edge_pose(double pitch_deg, double roll_deg, double travel_mm) {
  Configuration q(3);
  q << pitch_deg * deg, roll_deg * deg, travel_mm * mm;
  return q;
}

MotionGuard guard_of(const std::shared_ptr<const Device>& device) {
  return MotionGuard(device, device->settings().transport->servos);
}

/// The most that a joint moved.
double travel_in_step(MotionGuard& guard, const Configuration& wanted, double dt = kEdgeTick) {
  const JointAngles before = guard.joints();
  guard.step(wanted, dt);
  return (guard.joints() - before).cwiseAbs().maxCoeff();
}

TEST(MotionGuardEdges, FromRestItIsAsQuickAsTheAccelerationAllowsAndNoSlower) {
  const auto device = lever_platform({.acceleration = kEdgeAcceleration});
  for (const double way : {-15.0, 20.0}) {
    MotionGuard guard = guard_of(device);
    if (way > 0.0) guard.reset(edge_pose(0, 0, -15));
    double rate = 0.0;
    const double lost = 2.01 * guard.servos()[0].resolution();  // to rounding, a tick
    for (int k = 0; k < 4; ++k) {
      const double most = std::min(kEdgeRate, rate + kEdgeAcceleration * kEdgeTick) * kEdgeTick;
      const double travel = travel_in_step(guard, edge_pose(0, 0, way));
      EXPECT_LE(travel, most + 1e-9) << k;
      EXPECT_GE(travel, most - lost) << k;
      rate = travel / kEdgeTick;
    }
    EXPECT_GT(rate, 0.6 * kEdgeRate);
  }
}

TEST(MotionGuardEdges, WhereItHeldItStartsFromRest) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto device = lever_platform({.acceleration = kEdgeAcceleration});
  for (const Configuration& no_pose :
       {edge_pose(nan, 0, 0), Configuration(Configuration::Zero(2))}) {
    MotionGuard guard = guard_of(device);
    guard.reset(edge_pose(0, 0, 15));
    for (int k = 0; k < 4; ++k) guard.step(edge_pose(0, 0, -15), kEdgeTick);
    ASSERT_GT(travel_in_step(guard, edge_pose(0, 0, -15)),
              2.0 * kEdgeAcceleration * kEdgeTick * kEdgeTick);
    guard.step(edge_pose(0, 0, -15), kEdgeTick);
    EXPECT_EQ(travel_in_step(guard, no_pose), 0.0);
    EXPECT_FALSE(guard.arrived());
    EXPECT_LE(travel_in_step(guard, edge_pose(0, 0, -15)),
              kEdgeAcceleration * kEdgeTick * kEdgeTick + 1e-9);
  }
}

TEST(MotionGuardEdges, AResetIsARest) {
  const auto device = lever_platform({.acceleration = kEdgeAcceleration});
  MotionGuard guard = guard_of(device);
  guard.reset(edge_pose(0, 0, 15));
  for (int k = 0; k < 5; ++k) guard.step(edge_pose(0, 0, -15), kEdgeTick);
  guard.reset(edge_pose(0, 0, 15));
  EXPECT_TRUE(guard.arrived());
  EXPECT_LE(travel_in_step(guard, edge_pose(0, 0, -15)),
            kEdgeAcceleration * kEdgeTick * kEdgeTick + 1e-9);
}

TEST(MotionGuardEdges, WithoutTimeItHasNotArrived) {
  const auto device = lever_platform();
  for (const double dt : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    MotionGuard guard = guard_of(device);
    EXPECT_TRUE(guard.arrived());
    guard.step(device->home(), dt);
    EXPECT_FALSE(guard.arrived());
    guard.step(device->home(), kEdgeTick);
    EXPECT_TRUE(guard.arrived());
  }
}

// Far outside, the nearest allowed on the way from home is reached, to a hundredth of a millimetre
// and a degree.
TEST(MotionGuardEdges, ReachesTheEdgeOfTheWorkspaceOnTheWayFromHome) {
  const auto device = lever_platform();
  for (const double far : {100.0, 1e9}) {
    MotionGuard guard = guard_of(device);
    for (int k = 0; k < 60; ++k) guard.step(edge_pose(0, 0, far), kEdgeTick);
    EXPECT_TRUE(guard.arrived());
    EXPECT_NEAR(guard.joints().maxCoeff(), 90.0 * deg, 0.1 * deg);
    EXPECT_NEAR(guard.configuration()[0], 0.0, 1e-3 * deg);
    for (int k = 0; k < 60; ++k) guard.step(edge_pose(0, 0, -far), kEdgeTick);
    EXPECT_TRUE(guard.arrived());
    EXPECT_NEAR(guard.joints().minCoeff(), -20.0 * deg, 0.1 * deg);
  }
  for (const Eigen::Index axis : {0, 1}) {
    for (const double far : {80.0 * deg, 1e9}) {
      MotionGuard guard = guard_of(device);
      const Configuration goal = far * Configuration::Unit(3, axis);
      for (int k = 0; k < 60; ++k) guard.step(goal, kEdgeTick);
      EXPECT_TRUE(guard.arrived());
      EXPECT_NEAR(guard.configuration()[axis], 30.0 * deg, 0.2 * deg) << axis << ' ' << far;
    }
  }
}

TEST(MotionGuardEdges, TakesAPoseExactlyOnALimit) {
  const auto device = lever_platform();
  JointAngles most = device->joint_limits().max;
  Configuration q;
  ASSERT_TRUE(device->forward_kinematics(most, q));
  MotionGuard guard = guard_of(device);
  guard.reset(q);
  // 60 degrees from home, a five hundredth nearer.
  EXPECT_NEAR((guard.joints() - most).cwiseAbs().maxCoeff(), 0.0, 0.15 * deg);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(guard.servos()[i].joint_of_target(guard.targets()[i]), 90.0 * deg + 1e-7);
  }
}

// Where the straight way is open it is gone straight, not by home.
TEST(MotionGuardEdges, GoesStraightWhereItCan) {
  const auto device = lever_platform({.wedge = true});
  MotionGuard guard = guard_of(device);
  const Configuration from = edge_pose(3, 20, 0);
  const Configuration to = edge_pose(3, -20, 0);
  guard.reset(from);
  for (int k = 0; k < 60 && !(k > 0 && guard.arrived()); ++k) {
    guard.step(to, kEdgeTick);
    EXPECT_NEAR(guard.configuration()[0], 3.0 * deg, 0.05 * deg);
  }
  EXPECT_EQ(guard.configuration(), to);
}

// What is slow to start is not blocked.
TEST(MotionGuardEdges, GoesAsFarAsTheWayIsOpenHoweverLittleItMayAccelerate) {
  const auto device = lever_platform({.wedge = true, .acceleration = 0.1 * kEdgeRate});
  MotionGuard guard(device, {});
  guard.reset(edge_pose(0, 25, 0));
  guard.step(edge_pose(20, -21, 0), kEdgeTick);
  EXPECT_GT(guard.configuration()[0], 0.0) << "home has no pitch";
}

// On a detour it has not arrived, at home neither.
TEST(MotionGuardEdges, OnADetourItHasNotArrived) {
  const auto device = lever_platform({.wedge = true});
  MotionGuard guard = guard_of(device);
  guard.reset(edge_pose(0, 25, 0));
  const Configuration goal = edge_pose(20, -21, 0);
  int ticks = 0;
  while (!guard.arrived() || ticks == 0) {
    guard.step(goal, kEdgeTick);
    ASSERT_LT(++ticks, 100);
    EXPECT_EQ(guard.arrived(), (guard.configuration() - goal).norm() < 1e-12) << ticks;
  }
}

// What cannot be reached on the straight way from home is not sought: the last before it is.
TEST(MotionGuardEdges, StopsBeforeWhatBlocksTheWayFromHome) {
  const auto device = lever_platform({.wedge = true});
  MotionGuard guard = guard_of(device);
  for (int k = 0; k < 60; ++k) guard.step(edge_pose(20, 0, 0), kEdgeTick);
  EXPECT_TRUE(guard.arrived());
  EXPECT_NEAR(guard.configuration()[0], 5.0 * deg, 1e-9) << "a sixteenth of the way before it";
  EXPECT_NEAR(guard.configuration()[1], 0.0, 1e-9);
}

TEST(MotionGuardEdges, TargetsAreThoseOfTheJointsAsNearAsTheWireCan) {
  const auto device = lever_platform({.reversed_servo = true});
  MotionGuard guard = guard_of(device);
  for (int k = 0; k < 40; ++k) {
    guard.step(edge_pose(k % 2 == 0 ? 12 : -7, 5, k % 3), kEdgeTick);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(guard.servos()[i].joint_of_target(guard.targets()[i]),
                  guard.joints()[Eigen::Index(i)], 0.51 * guard.servos()[i].resolution());
    }
  }
}

TEST(MotionGuardEdges, WithoutServosItHasNoTargetsAndAllOfTheRate) {
  const auto device = lever_platform();
  MotionGuard guard(device, {});
  EXPECT_TRUE(guard.targets().empty());
  EXPECT_NEAR(travel_in_step(guard, edge_pose(0, 0, -15)), kEdgeRate * kEdgeTick,
              1e-4 * kEdgeRate * kEdgeTick);
  for (int k = 0; k < 60; ++k) guard.step(edge_pose(5, -5, 2), kEdgeTick);
  EXPECT_TRUE(guard.arrived());
  EXPECT_EQ(guard.configuration(), edge_pose(5, -5, 2));
}

// One servo of one unit of travel, and no rounding that holds it back.
TEST(MotionGuardEdges, AServoThatFollowsTravelHasTheTravelAsItsTarget) {
  const auto device = lever_platform({.kind = "weart"});
  MotionGuard guard = guard_of(device);
  ASSERT_EQ(guard.servos().size(), 1U);
  for (int k = 0; k < 60; ++k) {
    guard.step(edge_pose(0, 0, 3), kEdgeTick);
    const double travel = guard.configuration()[2];
    EXPECT_NEAR(guard.targets()[0] * 1e-6, std::clamp(0.1 * travel / mm, 0.0, 0.9), 1e-6);
  }
  EXPECT_NEAR(guard.configuration()[2], 3.0 * mm, 1e-12);
  // All of the rate.
  guard.reset(edge_pose(0, 0, 10));
  EXPECT_NEAR(travel_in_step(guard, edge_pose(0, 0, -10)), kEdgeRate * kEdgeTick,
              1e-4 * kEdgeRate * kEdgeTick);
}

}  // namespace
}  // namespace softfinger
