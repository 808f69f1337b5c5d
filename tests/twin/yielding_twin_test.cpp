#include "softfinger/twin/yielding_twin.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/twin/motor_torque.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
const fs::path kProject = source_folder();

std::shared_ptr<const FingerModel> index_finger() {
  return FingerModel::load(kProject / "fingers/index.toml");
}

/// A shipped device whose motors are like that.
std::shared_ptr<const Device> yielding(const std::string& name, const std::string& statics) {
  const fs::path file = kProject / "devices" / (name + ".toml");
  std::ifstream shipped(file);
  std::string text{std::istreambuf_iterator<char>(shipped), {}};
  const std::size_t own = text.find("\n[statics]");
  if (own != std::string::npos) {
    const std::size_t end = text.find("\n[", own + 1);
    text.erase(own, end == std::string::npos ? std::string::npos : end - own);
  }
  return load_device(file, text + "\n[statics]\n" + statics, 0.0);
}

/// Advanced from home so far.
Configuration advanced(const Device& device, double way) {
  Configuration q = device.home();
  device.advance(way, q);
  return q;
}

TEST(MotorTorque, IsNothingInThePlayThenGrowsThenEnds) {
  const MotorStatics statics{.holding = 0.05, .compliance = 2.0, .backlash = 0.02};
  EXPECT_EQ(motor_torque(statics, false, 0.0099).torque, 0.0);
  EXPECT_NEAR(motor_torque(statics, false, 0.05).torque, 0.02, 1e-15);
  EXPECT_NEAR(motor_torque(statics, false, -0.05).torque, -0.02, 1e-15);
  EXPECT_EQ(motor_torque(statics, false, 0.05).rate, 0.5);
  EXPECT_FALSE(motor_torque(statics, false, 0.1).gives_way);
  EXPECT_TRUE(motor_torque(statics, false, -0.2).gives_way);
  EXPECT_EQ(motor_torque(statics, false, -0.2).torque, -0.05);
  EXPECT_EQ(motor_torque({.holding = 0.05}, true, 1.0 * mm).torque, 0.05) << "stiff, not rigid";
}

// What a drive straight towards the finger bears is the force on the skin.
TEST(YieldingTwin, YieldsByTheForceTimesTheCompliance) {
  const auto model = index_finger();
  const auto device = yielding("strap-minamizawa", "compliance_mm_per_N = 0.2\n");
  YieldingTwin twin(model, device);
  const Configuration q = advanced(*device, 4.5 * mm);
  const YieldingSummary summary = twin.press(q, 0.0, 0.0);
  ASSERT_TRUE(summary.balanced);
  EXPECT_FALSE(summary.gives_way);
  const double force = normal_force_vector(twin.twin().contact()).z();
  EXPECT_GT(force, 0.1);
  EXPECT_NEAR(summary.torque, force, 1e-3 * force);
  EXPECT_NEAR(q[1] - twin.twin().configuration()[1], 0.2e-3 * force, 1e-7);
}

// The work of the skin on the device against the sum of forces times advance: the disk of a
// thimble, level, moves as one along z.
TEST(YieldingTwin, LoadAlongAnAdvanceIsTheNormalForce) {
  const auto model = index_finger();
  const auto device = yielding("thimble-3rrs", "backlash_deg = 0.1\n");
  Twin twin(model, device);
  twin.press(advanced(*device, 4.4 * mm), 0.0, 0.0);
  DeviceLoad load;
  ASSERT_TRUE(twin.load_and_derivative(load));
  const double force = normal_force_vector(twin.contact()).z();
  ASSERT_GT(force, 0.3);
  EXPECT_NEAR(load.load[2], -force, 1e-6 * force);
  EXPECT_LT(load.by_q(2, 2), 0.0) << "pressed further, it is pressed back harder";
}

// The derivative against differences, for a device that tilts, one that moves aside, and one that
// grows.
TEST(YieldingTwin, LoadGrowsAsItsDerivativeSays) {
  const auto model = std::make_shared<FingerModel>(*index_finger());
  model->feature_contact = false;  // which is seen from where the skin was
  for (const char* name : {"thimble-3rrs", "shear-tactor-gleeson", "membrane"}) {
    const auto device = load_device(kProject / "devices" / (std::string(name) + ".toml"));
    Twin twin(model, device);
    // The membrane rests nearer.
    const double way = std::string(name) == "membrane" ? 2.0 * mm : 4.4 * mm;
    const Configuration q = advanced(*device, way);
    const auto load_at = [&](const Configuration& at) {
      DeviceLoad load;
      twin.reset();
      twin.begin_frame(0.0, 0.0);
      twin.attempt(at);
      EXPECT_TRUE(twin.load_and_derivative(load)) << name;
      return load;
    };
    const DeviceLoad here = load_at(q);
    ASSERT_GT(here.load.norm(), 0.05) << name;
    for (Eigen::Index k = 0; k < std::min<Eigen::Index>(q.size(), 4); ++k) {
      const double h = 2e-6 / device->axes()[static_cast<std::size_t>(k)].metric;
      Configuration ahead = q;
      Configuration behind = q;
      ahead[k] += h;
      behind[k] -= h;
      const Eigen::VectorXd slope = (load_at(ahead).load - load_at(behind).load) / (2.0 * h);
      // That directions turn is left out of it: some parts in a hundred.
      EXPECT_LT((slope - here.by_q.col(k)).norm(), 0.1 * here.by_q.norm()) << name << " " << k;
    }
  }
}

struct Yields {
  const char* device;
  const char* statics;
};

class YieldingDevice : public testing::TestWithParam<Yields> {
 protected:
  std::shared_ptr<const FingerModel> model = index_finger();
  std::shared_ptr<const Device> device = yielding(GetParam().device, GetParam().statics);
  std::shared_ptr<const Device> rigid =
      load_device(kProject / "devices" / (std::string(GetParam().device) + ".toml"));
};

// Skin can only push: it presses less, never more, and motors bear something.
TEST_P(YieldingDevice, PressesLess) {
  YieldingTwin yields(model, device);
  Twin holds(model, rigid);
  int pressed = 0;
  for (const double way : {1.0, 3.2, 3.6, 4.0, 4.4, 4.0, 2.0}) {
    const Configuration q = advanced(*device, way * mm);
    if (!device->reachable(q)) continue;
    const YieldingSummary summary = yields.press(q, 0.0, 0.0);
    holds.press(q, 0.0, 0.0);
    EXPECT_TRUE(summary.balanced) << way;
    const double force = yields.twin().contact().normal_force;
    EXPECT_LE(force, holds.contact().normal_force * (1.0 + 1e-4) + 1e-4) << way;
    if (holds.contact().normal_force < 0.1) continue;
    ++pressed;
    EXPECT_GT(summary.torque, 0.0) << way;
    EXPECT_LT(force, holds.contact().normal_force) << way;
  }
  EXPECT_GE(pressed, 2);
}

INSTANTIATE_TEST_SUITE_P(
    Devices, YieldingDevice,
    testing::Values(Yields{"thimble-3rrs", "backlash_deg = 1.0\ncompliance_deg_per_N_mm = 0.02\n"},
                    Yields{"cable-prattichizzo", "backlash_deg = 1.0\n"},
                    Yields{"delta-schorr", "compliance_deg_per_N_mm = 0.05\n"},
                    Yields{"five-bar", "compliance_deg_per_N_mm = 0.05\n"},
                    Yields{"strap-minamizawa", "backlash_mm = 0.1\ncompliance_mm_per_N = 0.05\n"},
                    Yields{"plate-6dof", "compliance_deg_per_N_mm = 0.02\n"},
                    Yields{"membrane", "compliance_mm_per_N = 0.1\n"}),
    [](const auto& each) {
      std::string name = each.param.device;
      std::erase(name, '-');
      return name;
    });

// Virtual work: however far motors are sent, they press with no more than the torque that each
// holds times how much it turns by the advance, and where they give way it is told.
TEST(YieldingTwin, GivesWayWhereMotorsCannotHold) {
  const auto model = index_finger();
  constexpr double kHeld = 1e-3;  // N m
  const auto device = yielding("thimble-3rrs", "torque_N_mm = 1.0\n");
  YieldingTwin twin(model, device);
  Twin rigid(model, device);
  int gave_way = 0;
  for (const double way : {3.1, 3.4, 3.8, 4.2, 4.6}) {
    const Configuration q = advanced(*device, way * mm);
    const YieldingSummary summary = twin.press(q, 0.0, 0.0);
    rigid.press(q, 0.0, 0.0);
    EXPECT_TRUE(summary.balanced) << way;
    EXPECT_LE(summary.torque, kHeld * (1.0 + 1e-9)) << way;
    const Configuration& at = twin.twin().configuration();
    Configuration ahead = at;
    ahead[2] += 1e-6;
    JointAngles joints;
    JointAngles joints_ahead;
    ASSERT_TRUE(device->inverse_kinematics(at, joints));
    ASSERT_TRUE(device->inverse_kinematics(ahead, joints_ahead));
    const double most = kHeld * (joints_ahead - joints).cwiseAbs().sum() / 1e-6;
    const double force = normal_force_vector(twin.twin().contact()).norm();
    EXPECT_LE(force, 1.05 * most) << way;
    EXPECT_EQ(summary.gives_way, summary.torque >= kHeld) << way;
    if (!summary.gives_way) continue;
    ++gave_way;
    EXPECT_LT(force, rigid.contact().normal_force) << way;
  }
  EXPECT_GE(gave_way, 2);
  EXPECT_LT(gave_way, 5) << "the softest press is held";
}

}  // namespace
}  // namespace softfinger
