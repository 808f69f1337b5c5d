// Laws of the guard on devices of any kind: what it was before a reset does not matter, how coarse
// the wire is neither.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "../support/lever_platform.hpp"
#include "softfinger/actuation/motion_guard.hpp"

namespace softfinger {
namespace {

constexpr double kLawTick = 1.0 / 30.0;
constexpr double kResetTick = 0.3 * kLawTick;
constexpr double kShortTick = 0.1 * kLawTick;  ///< too short for a step over the wedge
constexpr double kLawRate = 400.0 * deg;

Configuration law_pose(double pitch_deg, double roll_deg, double travel_mm) {
  Configuration q(3);
  q << pitch_deg * deg, roll_deg * deg, travel_mm * mm;
  return q;
}

class MotionGuardLaws : public testing::Test {
 protected:
  Configuration any_pose(double tilt_deg, double travel_mm) {
    return law_pose(tilt_deg * uniform_(random_), tilt_deg * uniform_(random_),
                    travel_mm * uniform_(random_));
  }
  std::mt19937_64 random_{43};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

TEST_F(MotionGuardLaws, AfterAResetItIsAsNew) {
  for (const bool wedge : {false, true}) {
    const auto device = lever_platform({.wedge = wedge, .acceleration = kLawRate / 0.2});
    const auto& servos = device->settings().transport->servos;
    MotionGuard used(device, servos);
    int by_home = 0;
    for (int trial = 0; trial < 300; ++trial) {
      Configuration wanted = any_pose(35, 15);
      for (int k = 0; k < 20; ++k) used.step(wanted, kResetTick);
      Configuration from = any_pose(20, 8);
      if (trial % 2 == 0) from = law_pose(0, 25, 0);
      if (!device->reachable(from)) continue;
      MotionGuard fresh(device, servos);
      fresh.reset(from);
      used.reset(from);
      ASSERT_TRUE(used.arrived());
      wanted = trial % 2 == 0 ? law_pose(20, -21, 0) : any_pose(35, 15);
      double nearest = 1.0;
      for (int k = 0; k < 150; ++k) {
        fresh.step(wanted, kResetTick);
        used.step(wanted, kResetTick);
        ASSERT_EQ(used.configuration(), fresh.configuration()) << trial << ' ' << k;
        ASSERT_EQ(used.arrived(), fresh.arrived());
        nearest = std::min(nearest, fresh.configuration().norm());
        ASSERT_TRUE(std::ranges::equal(used.targets(), fresh.targets()));
      }
      by_home += trial % 2 == 0 && nearest < 1.0 * deg ? 1 : 0;
    }
    EXPECT_EQ(by_home > 100, wedge);
  }
}

/// Servos like the device's, on a wire of so many degrees a step.
std::vector<ServoSettings> servos_of_steps(const Device& device, double step_deg) {
  std::vector<ServoSettings> servos = device.settings().transport->servos;
  for (ServoSettings& servo : servos) servo.step = step_deg * deg * std::abs(servo.per_radian);
  return servos;
}

// From rest and from standstill, on wires that round to a hundredth of a degree and to three.
TEST_F(MotionGuardLaws, NoWireIsTooCoarseForTheLimits) {
  const auto device = lever_platform({.acceleration = kLawRate / 0.08});
  const JointLimits& limits = device->joint_limits();
  for (const double step_deg : {0.01, 0.088, 0.5, 3.0}) {
    MotionGuard guard(device, servos_of_steps(*device, step_deg));
    JointAngles joints = guard.joints();
    JointAngles rates = JointAngles::Zero(3);
    JointAngles sent;
    Configuration wanted = device->home();
    int moved = 0;
    for (int k = 0; k < 4000; ++k) {
      if (k % 7 == 0) wanted = any_pose(40, 12);
      const double dt = kLawTick * (0.2 + 0.8 * std::abs(uniform_(random_)));
      guard.step(wanted, dt);
      JointAngles told(3);
      for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i);
        told[i] = guard.servos()[at].joint_of_target(guard.targets()[at]);
        const double rate = (guard.joints()[i] - joints[i]) / dt;
        const double before = std::max(0.0, rate > 0.0 ? rates[i] : -rates[i]);
        ASSERT_LE(std::abs(rate), before + limits.max_acceleration * dt + 1e-9) << k;
        ASSERT_GE(told[i], limits.min[i] - 1e-7);
        ASSERT_LE(told[i], limits.max[i] + 1e-7);
        // A wire that is coarser than a tick's motion rounds by one of its steps at most.
        if (sent.size() == 3) {
          const double most =
              std::max(limits.max_rate * dt, 0.5 * limits.max_rate * dt + 1.0 * step_deg * deg);
          ASSERT_LE(std::abs(told[i] - sent[i]), most + 1e-9) << k << ' ' << step_deg;
        }
        rates[i] = rate;
      }
      Configuration q;
      ASSERT_TRUE(device->forward_kinematics(told, q)) << told.transpose() / deg;
      moved += guard.joints() != joints ? 1 : 0;
      joints = guard.joints();
      sent = told;
    }
    EXPECT_GT(moved, 1000) << step_deg;
  }
}

// Rounding takes from a tick what it may add, but never more than half of it.
TEST_F(MotionGuardLaws, HoweverShortTheTickItGetsOn) {
  const auto device = lever_platform();
  MotionGuard guard(device, device->settings().transport->servos);
  const double resolution = guard.servos()[0].resolution();
  for (const double dt : {1e-5, 1e-4, 1e-3}) {
    guard.reset(device->home());
    const JointAngles before = guard.joints();
    guard.step(law_pose(0, 0, 15), dt);
    const double most = kLawRate * dt;
    EXPECT_NEAR((guard.joints() - before).maxCoeff(), most - std::min(0.5 * most, 2.0 * resolution),
                1e-6)
        << dt;
  }
}

// Something in its way is no reason to turn before it is there.
TEST_F(MotionGuardLaws, GoesAsFarAsItCanBeforeItGoesByHome) {
  for (const double acceleration : {std::numeric_limits<double>::infinity(), kLawRate / 0.1}) {
    const auto device = lever_platform({.wedge = true, .acceleration = acceleration});
    MotionGuard guard(device, device->settings().transport->servos);
    guard.reset(law_pose(0, 25, 0));
    double farthest = 0.0;
    int ticks = 0;
    do {
      guard.step(law_pose(20, -21, 0), kShortTick);
      ASSERT_LT(++ticks, 1000);
      if (guard.configuration()[1] > 0.0) {
        farthest = std::max(farthest, guard.configuration()[0]);
      }
    } while (!guard.arrived());
    EXPECT_NEAR(farthest, 5.0 * deg, 0.2 * deg);
  }
}

// It holds on to what is allowed for as long as it can: away from it only towards home.
TEST_F(MotionGuardLaws, WithoutServosItTakesWhatIsJustOutsideFromJustInside) {
  const auto device = lever_platform();
  MotionGuard guard(device, {});
  Configuration q;
  ASSERT_TRUE(device->forward_kinematics(device->joint_limits().max, q));
  for (const double beyond : {1e-4, 1e-3, 3e-3, 5e-3, 7e-3}) {
    const Configuration outside = (1.0 + beyond) * q;
    ASSERT_FALSE(device->reachable(outside));
    guard.reset(outside);
    EXPECT_TRUE(device->reachable(guard.configuration())) << beyond;
    EXPECT_NEAR((guard.configuration() - outside).norm() / q.norm(), beyond, 2.1e-3);
  }
}

// Poses whose way from the present one rounds.
TEST_F(MotionGuardLaws, ReachesWhatIsWantedToTheLastBit) {
  const auto device = lever_platform();
  MotionGuard guard(device, device->settings().transport->servos);
  for (int trial = 0; trial < 200; ++trial) {
    const Configuration wanted = any_pose(12, 4);
    for (int k = 0; k < 30 && (k == 0 || !guard.arrived()); ++k) guard.step(wanted, kLawTick);
    ASSERT_TRUE(guard.arrived());
    ASSERT_EQ(guard.configuration(), wanted);
  }
}

}  // namespace
}  // namespace softfinger
