#include "softfinger/session/scene_snapshot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include "../support/folders.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kShipped = source_folder();

class EveryDevice : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    RunOptions options;
    options.scene = scenes_.scene("edge");
    options.devices = {scenes_.device(GetParam()).string()};
    options.actuator.port = "emulator";
    setup_ = load_setup(options);
    DeviceLoopOptions device_options;
    device_options.actuator.port = "emulator";
    device_options.actuator.simulated_time = true;
    loop_ = std::make_unique<DeviceLoop>(0, setup_->devices[0], setup_->models[0], device_options);
  }
  [[nodiscard]] const Device& device() const { return *setup_->devices[0]; }

  ScenesWithoutForceLimit scenes_;
  std::shared_ptr<const RunSetup> setup_;
  std::unique_ptr<DeviceLoop> loop_;
};

// The page draws what presses the finger: every piece, where it is.
TEST_P(EveryDevice, IsDrawnPieceByPiece) {
  const SceneDescription scene = describe(*setup_);
  Snapshot snapshot = initial_snapshot(*setup_);
  fill(snapshot.fingers[0], initial_feedback(*loop_));
  std::vector<SolidPiece> pieces(static_cast<std::size_t>(device().solid_piece_count()));
  device().solid_pieces(device().home(), pieces);
  ASSERT_EQ(scene.fingers[0].pieces.size(), pieces.size());
  ASSERT_EQ(snapshot.fingers[0].pieces.size(), pieces.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Snapshot::Piece& drawn = snapshot.fingers[0].pieces[k];
    EXPECT_EQ(scene.fingers[0].pieces[k].index(), pieces[k].shape.index());
    EXPECT_TRUE(drawn.X_FS.translation.isApprox(pieces[k].X_FS.translation));
    EXPECT_TRUE(drawn.X_FS.rotation.isApprox(pieces[k].X_FS.rotation));
    const auto* ball = std::get_if<Ball>(&pieces[k].shape);
    EXPECT_EQ(drawn.ball_radius, ball != nullptr ? ball->radius : 0.0);
  }
  EXPECT_EQ(snapshot.fingers[0].linkage_F.size(),
            static_cast<std::size_t>(3 * device().leg_count()));
}

// Where the page says the workspace ends, it ends.
TEST_P(EveryDevice, WorkspaceIsWhatItReaches) {
  const WorkspaceOutline workspace = describe(*setup_).fingers[0].workspace;
  EXPECT_NE(workspace.reaches.empty(), workspace.tilt_layers.empty());
  for (const AxisReach& reach : workspace.reaches) EXPECT_LT(reach.min, reach.max) << reach.name;
  if (workspace.pitch_axis < 0 || workspace.roll_axis < 0) return;
  const WorkspaceOutline::TiltLayer& layer =
      workspace.tilt_layers[workspace.tilt_layers.size() / 2];
  const double most = *std::max_element(layer.tilts.begin(), layer.tilts.end());
  for (std::size_t k = 0; k < layer.tilts.size(); ++k) {
    const double direction =
        2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(layer.tilts.size());
    const auto reached = [&](double tilt) {
      Configuration q = device().home();
      q[workspace.pitch_axis] = tilt * std::cos(direction);
      q[workspace.roll_axis] = tilt * std::sin(direction);
      q[workspace.travel_axis] = layer.travel;
      return device().reachable(q);
    };
    EXPECT_TRUE(reached(0.999 * layer.tilts[k])) << k;
    EXPECT_TRUE(layer.tilts[k] >= most || !reached(layer.tilts[k] + 0.05 * deg)) << k;
  }
}

/// Files that differ by their motors alone look as one.
bool has_other_motors(const std::filesystem::path& device) {
  std::ifstream stream(device);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return text.find("[transport]") != std::string::npos &&
         text.find("kind = \"maestro\"") == std::string::npos;
}

std::vector<std::string> shipped_devices() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kShipped / "devices")) {
    if (entry.path().extension() != ".toml" || has_other_motors(entry.path())) continue;
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Shipped, EveryDevice, testing::ValuesIn(shipped_devices()),
                         [](const auto& device) {
                           std::string name = device.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// A membrane's ball grows as it is blown up, and is cut by the ring it bulges from.
TEST(SceneSnapshot, AMembraneChangesItsShape) {
  const auto device = load_device(kShipped / "devices/membrane.toml");
  DeviceFeedback feedback;
  feedback.pieces.resize(2);
  Snapshot::Finger flat;
  flat.pieces.resize(2);
  Snapshot::Finger blown = flat;
  feedback.tick.command.configuration = device->home();
  device->solid_pieces(device->home(), feedback.pieces);
  fill(flat, feedback);
  device->solid_pieces(Configuration::Constant(1, 3 * mm), feedback.pieces);
  fill(blown, feedback);
  EXPECT_GT(flat.pieces[0].ball_radius, 10 * blown.pieces[0].ball_radius);
  // A ball of radius (r^2 + h^2) / (2 h) rises h over a ring of radius r.
  const double ring = device->cap_radius();
  EXPECT_NEAR(blown.pieces[0].ball_radius, (ring * ring + 9 * mm2) / (6 * mm), 1e-12);
  EXPECT_EQ(blown.pieces[1].ball_radius, 0.0);
}

TEST(SceneSnapshot, TellsWhatAnObjectMovesBy) {
  const auto joint_of = [](const char* scene) {
    RunOptions options;
    options.scene = kShipped / "scenes" / scene;
    return describe(*load_setup(options)).objects[0].joint;
  };
  EXPECT_EQ(joint_of("knob.toml"), "hinge");
  EXPECT_EQ(joint_of("button.toml"), "slider");
  EXPECT_EQ(joint_of("sphere.toml"), "");
}

// The surface of something soft is told in a frame that goes with it: what is left is its
// deformation.
TEST(SceneSnapshot, SomethingSoftIsDrawnAsItStands) {
  RunOptions options;
  options.scene = kShipped / "scenes/sponge.toml";
  const std::shared_ptr<const RunSetup> setup = load_setup(options);
  const SoftSolid& sponge = *setup->scene.objects[0].soft;
  const SceneDescription::Object told = describe(*setup).objects[0];
  Snapshot snapshot = initial_snapshot(*setup);
  ASSERT_EQ(snapshot.soft_objects.size(), 1U) << "the table is not soft";
  Snapshot::SoftObject& soft = snapshot.soft_objects[0];
  EXPECT_EQ(soft.object, 0U);
  ASSERT_EQ(soft.positions_O.size(), told.positions_O.size());
  ASSERT_GT(soft.positions_O.size(), 100U);
  EXPECT_EQ(soft.positions_O[7], told.positions_O[7].cast<float>());
  // Elsewhere, turned, and one node out of its place.
  const Pose X_WO{exp_rotation(Vector3(0.3, -0.2, 1.0)), Vector3(0.1, 0.2, 0.3)};
  std::vector<Vector3> nodes;
  for (const Vector3& at : sponge.mesh.nodes) nodes.push_back(X_WO * at);
  nodes[static_cast<std::size_t>(sponge.sample_nodes[7])] += X_WO.rotation * Vector3(0, 0, 1 * mm);
  fill(soft, sponge, X_WO, nodes);
  for (std::size_t i = 0; i < soft.positions_O.size(); ++i) {
    const Vector3 moved = i == 7 ? Vector3(0, 0, 1 * mm) : Vector3::Zero();
    EXPECT_LT((soft.positions_O[i].cast<double>() - told.positions_O[i] - moved).norm(), 1e-8) << i;
  }
}

}  // namespace
}  // namespace softfinger
