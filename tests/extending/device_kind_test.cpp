// The worked example of docs/extending.md: a kind of device of one's own.
#include <gtest/gtest.h>

#include <string>

#include "device_kind/lead_screw.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {
namespace {

std::shared_ptr<const Device> lead_screw_of(const std::string& text) {
  const ConfigFile file("device.toml", text);
  DeviceSettings settings;
  settings.kind = lead_screw_kind().name;
  return lead_screw_kind().read(file, settings);
}

TEST(LeadScrew, TurnsAQuarterForAQuarterOfItsLeadAndCarriesADisk) {
  const auto device = lead_screw_of(lead_screw_kind().example);
  Configuration q = Configuration::Constant(1, 3.0 * mm);
  JointAngles joints;
  ASSERT_TRUE(device->inverse_kinematics(q, joints));
  EXPECT_NEAR(joints[0], 90.0 * deg, 1e-9);
  Configuration back;
  ASSERT_TRUE(device->forward_kinematics(joints, back));
  EXPECT_NEAR(back[0], 3.0 * mm, 1e-15);
  EXPECT_EQ(device->disk_radius(), 6.0 * mm);
  // 1 mm over the disk's centre, and the distance falls as the disk travels.
  const Vector3 p_F = device->surface_pose(q) * Vector3(0.0, 0.0, 1.0 * mm);
  const SurfaceDistance surface = device->signed_distance(q, p_F);
  EXPECT_NEAR(surface.distance, 1.0 * mm, 1e-12);
  EXPECT_NEAR(surface.gradient[0], -1.0, 1e-12);
}

TEST(LeadScrew, ItsWorkspaceIsThatOfItsScrew) {
  const auto device = lead_screw_of(lead_screw_kind().example);
  EXPECT_TRUE(device->reachable(Configuration::Constant(1, 0.5 * 12.0 * mm)));
  EXPECT_FALSE(device->reachable(Configuration::Constant(1, 0.501 * 12.0 * mm)));
}

TEST(LeadScrew, AKeyThatIsNoneAndARestOutOfReachAreRefusedByName) {
  const std::string example = lead_screw_kind().example;
  for (const std::string& wrong :
       {example + "\n[home]\ntravel_mm = 9.0\n", example + "\n[gear]\n"}) {
    try {
      (void)lead_screw_of(wrong);
      ADD_FAILURE() << wrong;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("device.toml:"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace softfinger
