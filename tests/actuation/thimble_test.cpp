// The limits of every command on the device that ships.
#include <gtest/gtest.h>

#include <random>

#include "../support/folders.hpp"
#include "softfinger/actuation/motion_guard.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {
namespace {

constexpr double kThimbleTick = 1.0 / 30.0;
constexpr double kMaxTilt = 30.0 * deg;

class Thimble : public testing::Test {
 protected:
  std::shared_ptr<const Device> device_ =
      load_device(source_folder() + "/devices/thimble-3rrs.toml");
  std::mt19937_64 random_{17};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};

  Configuration any(double tilt_deg, double travel_mm) {
    Configuration q(3);
    q << tilt_deg * deg * uniform_(random_), tilt_deg * deg * uniform_(random_),
        travel_mm * mm * uniform_(random_);
    return q;
  }
};

TEST_F(Thimble, EveryCommandIsWithinLimitsAsSent) {
  MotionGuard guard(device_, device_->settings().transport->servos);
  const JointLimits& limits = device_->joint_limits();
  JointAngles last;
  Configuration wanted = device_->home();
  int moved = 0;
  for (int k = 0; k < 20000; ++k) {
    if (k % 5 == 0) wanted = any(45, 15);
    const double dt = kThimbleTick * (0.2 + 0.8 * std::abs(uniform_(random_)));
    const Configuration before = guard.configuration();
    guard.step(wanted, dt);
    moved += guard.configuration() != before ? 1 : 0;
    JointAngles joints(3);
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(i);
      joints[i] = guard.servos()[at].joint_of_target(guard.targets()[at]);
      ASSERT_GE(joints[i], limits.min[i] - 1e-7);
      ASSERT_LE(joints[i], limits.max[i] + 1e-7);
    }
    if (k > 0) {
      ASSERT_LE((joints - last).cwiseAbs().maxCoeff(), limits.max_rate * dt + 1e-9);
    }
    last = joints;
    Configuration q;
    ASSERT_TRUE(device_->forward_kinematics(joints, q)) << joints.transpose() / deg;
    ASSERT_LE(std::hypot(q[0], q[1]), kMaxTilt + 1e-8);
  }
  EXPECT_GT(moved, 10000);
}

TEST_F(Thimble, RetractsFromAnywhereInTheWorkspaceWithoutDelay) {
  MotionGuard guard(device_, device_->settings().transport->servos);
  const double allowed = device_->joint_limits().max_rate * kThimbleTick;
  JointAngles retracted;
  ASSERT_TRUE(device_->inverse_kinematics(device_->retracted(), retracted));
  int tried = 0;
  int longest = 0;
  while (tried < 2000) {
    const Configuration from = any(30, 15);
    if (!device_->reachable(from)) continue;
    ++tried;
    guard.reset(from);
    const double way = (guard.joints() - retracted).cwiseAbs().maxCoeff();
    int ticks = 0;
    do {
      guard.step(device_->retracted(), kThimbleTick);
      ASSERT_LT(++ticks, 60) << from.transpose();
    } while (!guard.arrived());
    EXPECT_LE(ticks, std::ceil(1.5 * way / allowed) + 1) << from.transpose();
    longest = std::max(longest, ticks);
  }
  EXPECT_LE(longest * kThimbleTick, 0.7);
}

TEST_F(Thimble, ReachesEveryPoseOfTheWorkspace) {
  MotionGuard guard(device_, device_->settings().transport->servos);
  int tried = 0;
  while (tried < 1000) {
    const Configuration goal = any(30, 15);
    if (!device_->reachable(goal)) continue;
    ++tried;
    int ticks = 0;
    do {
      guard.step(goal, kThimbleTick);
      ASSERT_LT(++ticks, 60) << goal.transpose();
    } while (!guard.arrived());
    EXPECT_LT((guard.configuration() - goal).norm(), 0.2 * deg);
  }
}

}  // namespace
}  // namespace softfinger
