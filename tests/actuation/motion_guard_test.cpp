#include "softfinger/actuation/motion_guard.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "../support/lever_platform.hpp"

namespace softfinger {
namespace {

constexpr double kGuardTick = 1.0 / 30.0;

/// Looks at commands as the wire sees them.
class CommandWatch {
 public:
  explicit CommandWatch(const Device& device) : device_(device) {}

  void check(const MotionGuard& guard, double dt) {
    const auto targets = guard.targets();
    ASSERT_EQ(targets.size(), 3u);
    JointAngles joints(3);
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(i);
      joints[i] = guard.servos()[at].joint_of_target(targets[at]);
      ASSERT_GE(joints[i], device_.joint_limits().min[i] - 1e-7);
      ASSERT_LE(joints[i], device_.joint_limits().max[i] + 1e-7);
      if (last_.size() == 3) {
        ASSERT_LE(std::abs(joints[i] - last_[i]), device_.joint_limits().max_rate * dt + 1e-9);
      }
    }
    Configuration q;
    ASSERT_TRUE(device_.forward_kinematics(joints, q)) << joints.transpose() / deg;
    ASSERT_LE(std::hypot(q[0], q[1]), LeverPlatform::kMaxTilt + 1e-9);
    last_ = joints;
  }

 private:
  const Device& device_;
  JointAngles last_;
};

Configuration q_of(double pitch_deg, double roll_deg, double travel_mm) {
  Configuration q(3);
  q << pitch_deg * deg, roll_deg * deg, travel_mm * mm;
  return q;
}

TEST(MotionGuard, ReachesWhatIsAllowed) {
  const auto device = lever_platform();
  MotionGuard guard(device, device->settings().transport->servos);
  EXPECT_EQ(guard.configuration(), device->home());
  const Configuration wanted = q_of(5, -3, 2);
  int ticks = 0;
  while (!guard.arrived() || ticks == 0) {
    guard.step(wanted, kGuardTick);
    ASSERT_LT(++ticks, 30);
  }
  EXPECT_EQ(guard.configuration(), wanted);
}

TEST(MotionGuard, MovesAtTheRateLimitAndNoSlower) {
  const auto device = lever_platform();
  MotionGuard guard(device, device->settings().transport->servos);
  const JointAngles before = guard.joints();
  guard.step(q_of(0, 0, -15), kGuardTick);
  const double travel = (guard.joints() - before).cwiseAbs().maxCoeff();
  EXPECT_LE(travel, 400 * deg * kGuardTick);
  EXPECT_GE(travel, 0.99 * 400 * deg * kGuardTick);
}

/// A lever platform whose joints need 80 ms to get to full speed.
std::shared_ptr<const Device> lazy_platform() {
  return lever_platform({.acceleration = 400.0 * deg / 0.08});
}

TEST(MotionGuard, NoJointGetsFasterThanItMay) {
  const auto device = lazy_platform();
  const JointLimits& limits = device->joint_limits();
  MotionGuard guard(device, device->settings().transport->servos);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::uniform_real_distribution<double> tick(0.005, kGuardTick);
  JointAngles joints = guard.joints();
  JointAngles rates = JointAngles::Zero(3);
  Configuration wanted = q_of(0, 0, 0);
  double fastest = 0.0;
  for (int k = 0; k < 5000; ++k) {
    if (k % 7 == 0) wanted = q_of(30 * unit(random), 30 * unit(random), 6 * unit(random));
    const double dt = tick(random);
    guard.step(wanted, dt);
    for (int i = 0; i < 3; ++i) {
      const double rate = (guard.joints()[i] - joints[i]) / dt;
      const double before = std::max(0.0, rate > 0.0 ? rates[i] : -rates[i]);
      ASSERT_LE(std::abs(rate), before + limits.max_acceleration * dt + 1e-9) << k;
      rates[i] = rate;
      fastest = std::max(fastest, std::abs(rate));
    }
    joints = guard.joints();
  }
  EXPECT_GT(fastest, 0.5 * limits.max_rate);
}

TEST(MotionGuard, ReachesWhatIsAllowedHoweverLazy) {
  const auto device = lazy_platform();
  MotionGuard guard(device, device->settings().transport->servos);
  const Configuration wanted = q_of(10, -10, 4);
  int ticks = 0;
  while (!guard.arrived() || ticks == 0) {
    guard.step(wanted, kGuardTick);
    ASSERT_LT(++ticks, 30);
  }
  EXPECT_EQ(guard.configuration(), wanted);
}

TEST(MotionGuard, StopsAtTheEdgeOfTheWorkspaceAndSlidesAlongIt) {
  const auto device = lever_platform();
  MotionGuard guard(device, device->settings().transport->servos);
  for (int k = 0; k < 100; ++k) {
    const double angle = 0.02 * k;
    guard.step(q_of(80 * std::cos(angle), 80 * std::sin(angle), 0), kGuardTick);
  }
  const Configuration& q = guard.configuration();
  EXPECT_NEAR(std::hypot(q[0], q[1]), LeverPlatform::kMaxTilt, 0.1 * deg);
  EXPECT_NEAR(std::atan2(q[1], q[0]), 0.02 * 99, 0.03);
}

TEST(MotionGuard, HoldsWhenWhatIsWantedIsNoNumber) {
  const auto device = lever_platform();
  MotionGuard guard(device, device->settings().transport->servos);
  for (int k = 0; k < 30; ++k) guard.step(q_of(10, 5, 1), kGuardTick);
  const Configuration before = guard.configuration();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  guard.step(q_of(kNaN, 0, 0), kGuardTick);
  guard.step(q_of(0, -kInfinity, 0), kGuardTick);
  guard.step(Configuration(), kGuardTick);
  guard.step(Configuration::Zero(7), kGuardTick);
  guard.step(q_of(0, 0, 0), kNaN);
  guard.step(q_of(0, 0, 0), -1.0);
  EXPECT_EQ(guard.configuration(), before);
}

// From wherever any motion has led it, around a forbidden wedge too.
TEST(MotionGuard, AlwaysFindsTheWayBack) {
  const auto device = lever_platform({.wedge = true});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int beyond = 0;
  for (int trial = 0; trial < 300; ++trial) {
    MotionGuard guard(device, device->settings().transport->servos);
    Configuration wanted = q_of(0, 0, 0);
    for (int k = 0; k < 200; ++k) {
      if (k % 5 == 0) wanted = q_of(40 * unit(random), 40 * unit(random), 15 * unit(random));
      guard.step(wanted, kGuardTick);
    }
    beyond += guard.configuration()[0] > 10.0 * deg ? 1 : 0;
    const Configuration left = guard.configuration();
    int ticks = 0;
    while (!guard.arrived() || ticks == 0) {
      guard.step(device->retracted(), kGuardTick);
      ASSERT_LT(++ticks, 200) << trial << ": from " << left.transpose();
    }
    EXPECT_EQ(guard.configuration(), device->retracted());
  }
  EXPECT_GT(beyond, 20) << "behind the wedge";
}

const LeverPlatform::Shape kShapes[] = {{}, {.wedge = true}, {.reversed_servo = true}};

class HostileGuard : public testing::TestWithParam<int> {};

TEST_P(HostileGuard, EveryCommandIsWithinLimits) {
  const auto device = lever_platform(kShapes[GetParam()]);
  MotionGuard guard(device, device->settings().transport->servos);
  CommandWatch watch(*device);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double hostile[] = {std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity(),
                            1e30,
                            -1e30,
                            1e308,
                            -1e308,
                            5e-324,
                            0.0};
  Configuration wanted = device->home();
  for (int k = 0; k < 100000; ++k) {
    const auto kind = random() % 8;
    if (kind < 3) {  // walks
      for (int i = 0; i < 3; ++i) wanted[i] += 0.02 * device->axes()[0].metric * uniform(random);
    } else if (kind < 6) {  // jumps, often outside
      wanted = q_of(60 * uniform(random), 60 * uniform(random), 30 * uniform(random));
    } else if (kind == 6) {
      wanted[static_cast<int>(random() % 3)] = hostile[random() % std::size(hostile)];
    }  // else: stays
    const double dt = kGuardTick * (0.05 + 0.95 * std::abs(uniform(random)));
    guard.step(wanted, dt);
    watch.check(guard, dt);
    if (HasFatalFailure()) FAIL() << "command " << k << ", wanted " << wanted.transpose();
    if (!wanted.allFinite()) wanted = guard.configuration();
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, HostileGuard, testing::Range(0, 3));

int ticks_to(MotionGuard& guard, const Configuration& goal) {
  for (int ticks = 1; ticks < 100; ++ticks) {
    guard.step(goal, kGuardTick);
    if (guard.arrived()) return ticks;
  }
  return -1;
}

/// 1 mm into a point 2 mm above home at zero pitch, less with pitch.
std::shared_ptr<const TravelCeiling> low_ceiling(const std::shared_ptr<const Device>& device) {
  const Vector3 point = device->surface_pose(device->home()) * Vector3(0.0, 0.0, 2.0 * mm);
  return std::make_shared<TravelCeiling>(
      device, std::vector<Vector3>{point},
      std::vector<TravelCeiling::GridAxis>{{0, -30 * deg, 30 * deg, 3}},
      std::vector<double>{-1.0 * mm, 1.0 * mm, -2.0 * mm});
}

TEST(MotionGuard, NeverRisesAboveTheCeiling) {
  const auto device = lever_platform();
  const auto ceiling = low_ceiling(device);
  MotionGuard guard(device, device->settings().transport->servos, ceiling);
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int at_ceiling = 0;
  for (int k = 0; k < 5000; ++k) {
    guard.step(q_of(40 * uniform(random), 40 * uniform(random), 20 * uniform(random)), kGuardTick);
    ASSERT_LE(ceiling->excess(guard.configuration()), 1e-9);
    JointAngles sent(3);
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(i);
      sent[i] = guard.servos()[at].joint_of_target(guard.targets()[at]);
    }
    Configuration q;
    ASSERT_TRUE(device->forward_kinematics(sent, q));
    ASSERT_LE(ceiling->excess(q), 1e-9) << "of the pulses sent";
    if (ceiling->excess(guard.configuration()) > -0.05 * mm) ++at_ceiling;
  }
  EXPECT_GT(at_ceiling, 100);
}

TEST(MotionGuard, ComesDownWhereItStandsAboveTheCeiling) {
  const auto device = lever_platform();
  const auto ceiling = low_ceiling(device);
  MotionGuard guard(device, device->settings().transport->servos, ceiling);
  guard.reset(q_of(0, 0, 8));
  EXPECT_GT(ceiling->excess(guard.configuration()), 2.0 * mm);
  double before = ceiling->excess(guard.configuration());
  for (int k = 0; k < 100; ++k) {
    guard.step(q_of(3, 0, 9), kGuardTick);
    const double now = ceiling->excess(guard.configuration());
    EXPECT_LE(now, std::max(before, 1e-9));
    before = now;
  }
  EXPECT_NEAR(before, -20e-6, 1e-6) << "a fiftieth of a millimetre below it, to stay there";
}

TEST(MotionGuard, GoesByHomeWhereTheStraightWayIsBlocked) {
  const auto device = lever_platform({.wedge = true});
  MotionGuard guard(device, device->settings().transport->servos);
  guard.reset(q_of(0, 25, 0));
  const Configuration goal = q_of(20, -21, 0);
  EXPECT_GT(ticks_to(guard, goal), 0);
  EXPECT_EQ(guard.configuration(), goal);
}

TEST(MotionGuard, RetractsFromAnywhere) {
  for (const bool wedge : {false, true}) {
    const auto device = lever_platform({.wedge = wedge});
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    int tried = 0;
    while (tried < 500) {
      const Configuration from =
          q_of(30 * uniform(random), 30 * uniform(random), 20 * uniform(random));
      // What is promised is the way by home.
      bool sees_home = true;
      for (double t = 0.0; t <= 1.0; t += 1e-3) sees_home &= device->reachable(t * from);
      if (!sees_home) continue;
      ++tried;
      MotionGuard guard(device, device->settings().transport->servos);
      guard.reset(from);
      EXPECT_GT(ticks_to(guard, device->retracted()), 0) << from.transpose();
    }
  }
}

}  // namespace
}  // namespace softfinger
