#include "softfinger/actuation/nearby_pose.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "../support/folders.hpp"
#include "../support/lever_platform.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {
namespace {

std::shared_ptr<const Device> shipped(const std::string& name) {
  return load_device(std::filesystem::path(source_folder()) / "devices" / (name + ".toml"));
}

// As far as the coarsest servo rounds: a step of 4096 a turn.
constexpr double kCoarse = 0.5 * 360.0 / 4096.0 * deg;

TEST(NearbyPose, HasTheJointAnglesToManyMoreDigitsThanTheyWereRoundedBy) {
  std::mt19937_64 random(29);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const char* name : {"thimble-3rrs", "delta-schorr", "five-bar", "thimble-3rrs-mechanism"}) {
    const auto device = shipped(name);
    int tried = 0;
    while (tried < 100) {
      Configuration near = device->home();
      for (Eigen::Index i = 0; i < near.size(); ++i) {
        near[i] += 5.0 * mm * uniform(random) / device->axes()[static_cast<std::size_t>(i)].metric;
      }
      JointAngles joints;
      if (!device->reachable(near) || !device->inverse_kinematics(near, joints)) continue;
      ++tried;
      for (double& joint : joints) joint += kCoarse * uniform(random);
      Configuration q;
      ASSERT_TRUE(nearby_pose(*device, joints, near, q)) << name;
      JointAngles reached;
      ASSERT_TRUE(device->inverse_kinematics(q, reached)) << name;
      ASSERT_LE((reached - joints).cwiseAbs().maxCoeff(), 1e-4 * kCoarse) << name;
    }
  }
}

// Whether it may go there is for others to say.
TEST(NearbyPose, IsOneBeyondLimitsToo) {
  const auto device = lever_platform();
  const JointAngles beyond = device->joint_limits().max.array() + kCoarse;
  Configuration q;
  ASSERT_FALSE(device->forward_kinematics(beyond, q));
  Configuration near;
  ASSERT_TRUE(device->forward_kinematics(device->joint_limits().max, near));
  ASSERT_TRUE(nearby_pose(*device, beyond, near, q));
  JointAngles reached;
  ASSERT_TRUE(device->inverse_kinematics(q, reached));
  EXPECT_LE((reached - beyond).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(NearbyPose, ThereIsNoneOfWhatIsNoNumber) {
  const auto device = lever_platform();
  JointAngles joints;
  ASSERT_TRUE(device->inverse_kinematics(device->home(), joints));
  joints[1] = std::numeric_limits<double>::quiet_NaN();
  Configuration q;
  EXPECT_FALSE(nearby_pose(*device, joints, device->home(), q));
  ASSERT_TRUE(device->inverse_kinematics(device->home(), joints));
  Configuration near = device->home();
  near[0] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(nearby_pose(*device, joints, near, q));
}

}  // namespace
}  // namespace softfinger
