#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "project.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/scene/scene.hpp"

// A plate is felt as a block is, however thin: skin is pushed out on the side it came from.
namespace softfinger {
namespace {

std::shared_ptr<const FingerModel> finger(const std::string& name, bool features) {
  auto model = std::make_shared<FingerModel>(*FingerModel::load(kProject / "fingers" / name));
  model->feature_contact = features;
  return model;
}

VirtualObject plate(double thickness) {
  VirtualObject object;
  object.shape = RoundedBox{Vector3(30.0 * mm, 30.0 * mm, 0.5 * thickness),
                            std::min(0.25 * mm, 0.25 * thickness)};
  const Pose pose{Matrix3::Identity(), Vector3(0.0, 0.0, -0.5 * thickness)};
  object.motion = Trajectory(std::vector<Waypoint>{{0.0, pose}});
  object.friction_coefficient = 0.5;
  return object;
}

struct Push {
  double from = 9.5 * mm, to = 5.5 * mm;
  double duration = 0.05;  ///< s
  double slide = 0.0;      ///< m, along x, meanwhile
};

struct Felt {
  double least = 1e9, most = 0.0;  ///< while held, N
  double lifted = 0.0;             ///< after lifting, N
  int unconverged = 0;
};

Felt push(const FingerModel& model, double thickness, double rate, const Push& way) {
  const VirtualObject object = plate(thickness);
  FingerSimulation simulation(std::make_shared<FingerModel>(model), {&object, 1}, 1.0 / rate);
  const auto pose = [](double x, double z) {
    return Pose{exp_rotation(Vector3(0.0, 6.0 * deg, 0.0)), Vector3(x, 0.0, z)};
  };
  simulation.reset(pose(0.0, way.from));
  Felt felt;
  int k = 0;
  const auto go = [&](double from, double to, double slide_from, double slide_to, double seconds,
                      auto&& visit) {
    const int steps = static_cast<int>(seconds * rate);
    for (int j = 1; j <= steps; ++j) {
      const double part = static_cast<double>(j) / steps;
      ++k;
      const double x = slide_from + (slide_to - slide_from) * part;
      const double z = from + (to - from) * part;
      if (!simulation.step(pose(x, z), k / rate).converged) ++felt.unconverged;
      visit();
    }
  };
  const auto nothing = [] {};
  go(way.from, way.to, 0.0, way.slide, way.duration, nothing);
  go(way.to, way.to, way.slide, way.slide, 0.05, nothing);
  go(way.to, way.to, way.slide, way.slide, 0.05, [&] {
    felt.least = std::min(felt.least, simulation.contact().normal_force);
    felt.most = std::max(felt.most, simulation.contact().normal_force);
  });
  go(way.to, way.from + 1.0 * mm, way.slide, way.slide, 0.1, nothing);
  felt.lifted = simulation.contact().normal_force;
  return felt;
}

void expect_plate_as_block(const FingerModel& model, double rate, const Push& way,
                           const std::string& what) {
  const Felt block = push(model, 20.0 * mm, rate, way);
  EXPECT_GT(block.least, 0.2) << what;
  for (const double thickness : {0.3, 0.2, 0.1, 0.05}) {
    const Felt felt = push(model, thickness * mm, rate, way);
    const std::string which = what + ", " + std::to_string(thickness) + " mm";
    EXPECT_NEAR(felt.least, block.least, 0.02 * block.least) << which;
    EXPECT_NEAR(felt.most, block.most, 0.02 * block.most) << which;
    EXPECT_EQ(felt.lifted, 0.0) << which;
    EXPECT_LE(felt.unconverged, block.unconverged) << which;
  }
}

TEST(ThinPlate, IsFeltAsABlock) {
  const auto model = finger("index.toml", true);
  expect_plate_as_block(*model, 1000.0, {}, "1 kHz");
  expect_plate_as_block(*model, 2000.0, {}, "2 kHz");
  expect_plate_as_block(*model, 5000.0, {}, "5 kHz");
}

TEST(ThinPlate, IsFeltAsABlockWithoutFeatures) {
  expect_plate_as_block(*finger("index.toml", false), 1000.0, {}, "without features");
}

TEST(ThinPlate, HoldsADeepPress) {
  expect_plate_as_block(*finger("index.toml", true), 1000.0,
                        {.from = 9.5 * mm, .to = 2.0 * mm, .duration = 0.3}, "deep");
}

TEST(ThinPlate, HoldsSkinThatSlides) {
  expect_plate_as_block(*finger("index.toml", true), 1000.0, {.slide = 10.0 * mm}, "sliding");
}

TEST(ThinPlate, HoldsABlow) {
  expect_plate_as_block(*finger("index.toml", true), 1000.0, {.duration = 0.008}, "0.5 m/s");
}

TEST(ThinPlate, IsFeltAsABlockByFinerFingers) {
  expect_plate_as_block(*finger("index-medium.toml", true), 1000.0, {}, "M");
}

}  // namespace
}  // namespace softfinger
