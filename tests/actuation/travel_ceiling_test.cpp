#include "softfinger/actuation/travel_ceiling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "../support/folders.hpp"
#include "../support/lever_platform.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {
namespace {

std::shared_ptr<const Device> device_of(const std::string& name) {
  return load_device(std::filesystem::path(source_folder()) / "devices" / (name + ".toml"));
}

/// One point 2 mm from the thimble's disk at travel 0, on its axis.
std::vector<Vector3> point_below(const Device& device) {
  return {device.surface_pose(device.home()) * Vector3(0.0, 0.0, 2.0 * mm)};
}

class ThimbleCeiling : public ::testing::Test {
 protected:
  std::shared_ptr<const Device> device = device_of("thimble-3rrs");
  // Depth 0.5 mm at the least pitch, 1.5 mm at the largest.
  TravelCeiling ceiling{device, point_below(*device), {{0, -0.4, 0.4, 2}}, {0.5 * mm, 1.5 * mm}};

  static Configuration q_of(double pitch, double travel) {
    Configuration q(3);
    q << pitch, 0.0, travel;
    return q;
  }
};

TEST_F(ThimbleCeiling, DepthIsWhatTheDeviceReachesIntoTheSkin) {
  const Configuration home = device->home();
  EXPECT_NEAR(ceiling.depth(home), -2.0 * mm, 1e-9);
  EXPECT_NEAR(ceiling.depth(q_of(0.0, home[2] + 2.7 * mm)), 0.7 * mm, 1e-9);
}

TEST_F(ThimbleCeiling, IsLinearBetweenNodesAndConstantBeyond) {
  for (const double pitch : {-0.4, -0.3, 0.0, 0.1, 0.4}) {
    const Configuration q = q_of(pitch, ceiling.travel(q_of(pitch, 2.0 * mm)));
    EXPECT_NEAR(ceiling.depth(q), 1.0 * mm + pitch / 0.8 * mm, 1e-6);
    EXPECT_NEAR(ceiling.excess(q), 0.0, 1e-6);
  }
  const Configuration beyond = q_of(0.7, ceiling.travel(q_of(0.7, 2.0 * mm)));
  EXPECT_NEAR(ceiling.depth(beyond), 1.5 * mm, 1e-6);
}

// A tip that is through the skin reaches no deeper into it, and is as far above the ceiling as
// ever.
TEST(TravelCeiling, HoldsATipThatWouldGoThroughTheSkin) {
  const auto device = device_of("delta-schorr");
  const Configuration home = device->home();
  const int axis = device->approach_axis();
  // A point that the tip meets 2 mm above home, its middle 3 mm later.
  const std::vector<Vector3> skin = {device->surface_pose(home) * Vector3(0.0, 0.0, 2.0 * mm)};
  const TravelCeiling ceiling(device, skin, {}, {0.5 * mm});
  for (const double above : {3.0, 5.0, 8.0, 9.5, 12.0}) {
    Configuration q = home;
    q[axis] += above * mm;
    EXPECT_NEAR(ceiling.travel(q), home[axis] + 2.5 * mm, 1e-6) << above;
    EXPECT_NEAR(ceiling.excess(q), (above - 2.5) * mm, 1e-6) << above;
    ceiling.lower(q);
    EXPECT_NEAR(q[axis], home[axis] + 2.5 * mm, 1e-6) << above;
  }
}

// A plate a millimetre thick that went through the skin, likewise.
TEST(TravelCeiling, HoldsAThinPlateThatWouldGoThroughTheSkin) {
  const auto device = device_of("strap-minamizawa");
  Configuration home = device->home();
  home[0] = 1.0 * mm;
  // Its frame is in its middle, half a millimetre below the side that touches.
  const std::vector<Vector3> skin = {device->surface_pose(home) * Vector3(0.0, 0.0, 2.5 * mm)};
  const TravelCeiling ceiling(device, skin, {}, {1.5 * mm});
  const int axis = device->approach_axis();
  for (const double above : {3.6, 4.5, 6.0}) {
    Configuration q = home;
    q[axis] += above * mm;
    EXPECT_NEAR(ceiling.excess(q), (above - 3.5) * mm, 1e-6) << above;
    ceiling.lower(q);
    EXPECT_NEAR(q[axis], home[axis] + 3.5 * mm, 1e-6) << above;
  }
}

// The only axis, which is the first.
TEST(TravelCeiling, HoldsADiskOfASingleDrive) {
  const auto device = device_of("disk-linear");
  const Configuration home = device->home();
  ASSERT_EQ(device->approach_axis(), 0);
  const TravelCeiling ceiling(device, point_below(*device), {}, {0.5 * mm});
  for (const double above : {0.0, 2.0, 4.0}) {
    Configuration q = home;
    q[0] += above * mm;
    EXPECT_NEAR(ceiling.depth(q), (above - 2.0) * mm, 1e-6) << above;
    EXPECT_NEAR(ceiling.travel(q), home[0] + 2.5 * mm, 1e-6) << above;
    EXPECT_NEAR(ceiling.excess(q), (above - 2.5) * mm, 1e-6) << above;
    ceiling.lower(q, 0.1 * mm);
    EXPECT_NEAR(q[0], home[0] + std::min(above, 2.4) * mm, 1e-6) << above;
  }
}

// Where a linkage does not close it says nothing of where the device is.
TEST(TravelCeiling, BeginsWhereTheLinkageCloses) {
  const auto device = device_of("five-bar");
  const int axis = device->approach_axis();
  JointAngles joints;
  int open = 0;
  for (const double x : {-8.0, -6.0, -3.0, 0.0, 4.0, 8.0}) {
    Configuration q = device->home();
    q[1 - axis] = x * mm;
    Configuration afar = q;
    afar[axis] = std::min(device->home()[axis], device->retracted()[axis]);
    if (!device->inverse_kinematics(afar, joints)) ++open;
    ASSERT_TRUE(device->inverse_kinematics(q, joints)) << x;
    // A point straight above the tip.
    std::vector<SolidPiece> tip(static_cast<std::size_t>(device->solid_piece_count()));
    device->solid_pieces(q, tip);
    const Vector3 point = tip.front().X_FS.translation + Vector3(0.0, 0.0, 10.0 * mm);
    const double px = point.x(), py = point.y(), pz = point.z();
    SurfaceSamples skin;
    skin.x = {&px, 1};
    skin.y = {&py, 1};
    skin.z = {&pz, 1};
    const double gap = device->least_distance(q, skin);
    ASSERT_GT(gap, 2.0 * mm) << x;
    const TravelCeiling ceiling(device, std::vector{point}, {}, {0.5 * mm});
    EXPECT_NEAR(ceiling.travel(q), q[axis] + gap + 0.5 * mm, 1e-6) << x;
  }
  EXPECT_GT(open, 0) << "none of these places is out of reach from afar";
}

/// A plane that a crank leads to the finger, by so many metres a radian.
class CrankedPlane : public PointwiseSurface<CrankedPlane> {
 public:
  static constexpr double kArm = 20.0 * mm;
  LevelPlane::Placed placed(const Kinematics&, const Configuration& q) const {
    return {kArm * q[2]};
  }
  void solid_pieces(const Kinematics&, const Configuration&, std::span<SolidPiece>) const override {
  }
};

// Depths are lengths, whatever leads the surface.
TEST(TravelCeiling, HoldsACrankAtItsDepth) {
  DeviceSettings settings = lever_settings({});
  settings.axes[2] = ConfigurationAxis::angle("crank_deg", CrankedPlane::kArm);
  settings.retracted[2] = -10.0 * deg;
  auto kinematics = std::make_unique<const LeverPlatform>(settings, false);
  const auto device = std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                                     std::make_unique<const CrankedPlane>());
  const TravelCeiling ceiling(device, std::vector{Vector3(0.0, 0.0, 2.0 * mm)}, {}, {0.5 * mm});
  for (const double height : {0.0, 1.0 * mm, 2.5 * mm, 4.0 * mm}) {
    Configuration q(3);
    q << 0.0, 0.0, height / CrankedPlane::kArm;
    EXPECT_NEAR(ceiling.depth(q), height - 2.0 * mm, 2e-7);
    EXPECT_NEAR(ceiling.travel(q) * CrankedPlane::kArm, 2.5 * mm, 2e-7);
    EXPECT_NEAR(ceiling.excess(q), height - 2.5 * mm, 2e-7);
    ceiling.lower(q);
    EXPECT_NEAR(q[2] * CrankedPlane::kArm, std::min(height, 2.5 * mm), 4e-7);
  }
}

TEST_F(ThimbleCeiling, LowersAlongTravelWhatIsAboveOnly) {
  for (const double pitch : {-0.4, -0.1, 0.0, 0.25}) {
    Configuration q = q_of(pitch, 6.0 * mm);
    const double travel = ceiling.travel(q);
    ceiling.lower(q);
    EXPECT_LE(ceiling.excess(q), 0.0);
    EXPECT_NEAR(q[2], travel, 2e-6);
    EXPECT_EQ(q[0], pitch);
    Configuration margin = q_of(pitch, 6.0 * mm);
    ceiling.lower(margin, 0.1 * mm);
    EXPECT_NEAR(ceiling.excess(margin), -0.1 * mm, 2e-6);
    const Configuration below = q_of(pitch, travel - 0.3 * mm);
    Configuration kept = below;
    ceiling.lower(kept);
    EXPECT_EQ(kept, below);
  }
}

TEST(TravelCeiling, HoldsEveryPin) {
  const auto device = device_of("pins-sarakoglou-4x4");
  const TravelCeiling ceiling(device, {}, {}, {1.0 * mm});
  Configuration q = Configuration::Constant(16, 0.5 * mm);
  q[3] = 1.5 * mm;
  EXPECT_NEAR(ceiling.excess(q), 0.5 * mm, 1e-12);
  ceiling.lower(q);
  EXPECT_EQ(q[3], 1.0 * mm);
  EXPECT_EQ(q[2], 0.5 * mm);
  EXPECT_EQ(ceiling.travel(q), 1.0 * mm) << "as far as every pin may";
}

}  // namespace
}  // namespace softfinger
