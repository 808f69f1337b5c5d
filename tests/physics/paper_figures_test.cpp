// The explorations of Perez et al. 2015 (figures 1, 2 and 7), judged tick by tick.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "../support/temporary_directory.hpp"
#include "project.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/run_setup.hpp"

namespace softfinger {
namespace {

/// What was known and answered at one device tick.
struct TickFrame {
  std::int64_t step = 0;
  Pose X_WF;
  Configuration q;
  bool touches = false;
  Vector3 centroid_F;
  std::vector<Vector3> samples_F;  ///< of the skin, m
};

TickFrame frame_of(const FingerChain& chain, const Configuration& wanted) {
  const ContactSet& contact = chain.loop().contact();
  TickFrame frame{.step = chain.device().record().step,
                  .X_WF = chain.virtual_finger().X_WF,
                  .q = wanted,
                  .touches = contact.contact_count > 0,
                  .centroid_F = contact.centroid_F};
  for (const ContactSample& sample : contact.samples) frame.samples_F.push_back(sample.position_F);
  return frame;
}

/// A scene explored by a finger with this mesh. The skin does not feel the device: the same
/// exploration leads one as it is shipped, and another as published.
class Exploration {
 public:
  Exploration(const std::string& finger, const std::string& scene) {
    RunOptions options;
    options.scene = scene_with(finger, scene);
    options.as_fast_as_possible = true;
    options.actuator.port = "emulator";
    const auto setup = load_setup(options);
    device_ = setup->devices.front();
    ActuatorOptions actuator = options.actuator;
    actuator.simulated_time = true;
    DeviceLoopOptions as_published = chain_options(*setup, 0, actuator).device_loop;
    as_published.objective = objective_kind("published");
    DeviceLoop published(0, device_, setup->models.front(), as_published);
    SceneRun::Hooks hooks;
    hooks.on_tick = [&](std::size_t, const FingerChain& chain) {
      shipped_.push_back(frame_of(chain, chain.device().record().wanted));
      const TickInput input = chain.tick_input(std::chrono::steady_clock::now());
      published_.push_back(frame_of(chain, published.tick(input, chain.virtual_finger()).wanted));
    };
    const std::atomic<bool> stop{false};
    run_headless(setup, options, stop, {}, std::move(hooks));
  }

  [[nodiscard]] const std::vector<TickFrame>& shipped() const { return shipped_; }
  [[nodiscard]] const std::vector<TickFrame>& published() const { return published_; }
  [[nodiscard]] Vector3 platform_normal_W(const TickFrame& frame) const {
    return frame.X_WF.rotation * device_->surface_pose(frame.q).rotation.col(2);
  }
  [[nodiscard]] const Device& device() const { return *device_; }

 private:
  /// The shipped scene with this finger; names of files are as seen from its folder.
  [[nodiscard]] std::filesystem::path scene_with(const std::string& finger,
                                                 const std::string& scene) const {
    std::ifstream in(kProject / "scenes" / (scene + ".toml"));
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto replace = [&](const std::string& before, const std::string& after) {
      const std::size_t at = text.find(before);
      ASSERT_NE(at, std::string::npos) << before;
      text.replace(at, before.size(), after);
    };
    replace("../fingers/index.toml", (kProject / "fingers" / (finger + ".toml")).string());
    replace("../devices/", (kProject / "devices").string() + "/");
    std::ofstream(folder_ / "scene.toml") << text;
    return folder_ / "scene.toml";
  }

  TemporaryDirectory folder_;
  std::shared_ptr<const Device> device_;
  std::vector<TickFrame> shipped_, published_;
};

double angle_deg(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / deg;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values.at(static_cast<std::size_t>(q * static_cast<double>(values.size() - 1)));
}

/// By a finger's mesh.
class PaperFigures : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Meshes, PaperFigures, testing::Values("index", "index-medium"),
                         [](const auto& one) {
                           return one.param == std::string("index") ? "S" : "M";
                         });

/// Depth of the bone over the plane against travel, where the finger only moves up or down.
void expect_travel_grows_with_depth(const TickFrame& before, const TickFrame& frame) {
  if (angle_deg(frame.X_WF.rotation.col(2), before.X_WF.rotation.col(2)) >= 1e-3) return;
  if ((frame.X_WF.translation - before.X_WF.translation).head<2>().norm() >= 1e-6) return;
  const double deeper = before.X_WF.translation.z() - frame.X_WF.translation.z();
  const double travel = frame.q[2] - before.q[2];
  if (std::abs(deeper) > 0.02e-3) {
    EXPECT_GT(travel * deeper, 0.0) << "step " << frame.step;
  }
}

void expect_smooth(const TickFrame& before, const TickFrame& frame) {
  const double bone_motion = (frame.X_WF.translation - before.X_WF.translation).norm() / mm;
  const double bone_turn = angle_deg(
      Eigen::AngleAxisd(frame.X_WF.rotation * before.X_WF.rotation.transpose()).toRotationMatrix() *
          Vector3::UnitZ(),
      Vector3::UnitZ());
  EXPECT_LE(std::abs(frame.q[2] - before.q[2]) / mm, 0.15 + bone_motion) << frame.step;
  EXPECT_LE((frame.q - before.q).head<2>().norm() / deg, 2.0 + bone_turn) << frame.step;
}

// A constant separation pushes the disk's rim off the skin that hovers beside the contact: `most`,
// degrees, is what the platform may be turned by.
void expect_on_plane(const Exploration& plane, const std::vector<TickFrame>& frames, double most) {
  int touching = 0;
  const TickFrame* before = nullptr;
  for (const TickFrame& frame : frames) {
    if (frame.touches) {
      ++touching;
      EXPECT_LT(angle_deg(plane.platform_normal_W(frame), Vector3::UnitZ()), most) << frame.step;
      if (before != nullptr && before->touches) {
        expect_travel_grows_with_depth(*before, frame);
        expect_smooth(*before, frame);
      }
    }
    before = &frame;
  }
  EXPECT_GT(touching, 100);
}

TEST_P(PaperFigures, OnThePlaneThePlatformIsThePlaneAndFollowsDepthSmoothly) {
  const Exploration plane(GetParam(), "plane");
  // For the force as well it leans a little on the coarse mesh.
  expect_on_plane(plane, plane.shipped(), GetParam() == std::string("index") ? 1.6 : 1.0);
  expect_on_plane(plane, plane.published(), 1.3);
}

void expect_on_sphere(const Exploration& sphere, const std::vector<TickFrame>& frames) {
  std::vector<double> angles;
  for (const TickFrame& frame : frames) {
    if (!frame.touches) continue;
    EXPECT_TRUE(sphere.device().reachable(frame.q)) << frame.step;
    // The ball is about the origin of the world.
    const Vector3 normal_W = (frame.X_WF * frame.centroid_F).normalized();
    angles.push_back(angle_deg(sphere.platform_normal_W(frame), normal_W));
  }
  ASSERT_GT(angles.size(), 100U);
  EXPECT_LT(quantile(angles, 0.5), 5.0);
}

TEST_P(PaperFigures, OnTheSphereThePlatformFacesTheSphereUnderTheContact) {
  const Exploration sphere(GetParam(), "sphere");
  expect_on_sphere(sphere, sphere.shipped());
  expect_on_sphere(sphere, sphere.published());
}

void expect_on_edge(const Exploration& edge, const std::vector<TickFrame>& all) {
  std::vector<double> tips;
  int frames = 0;
  int spared = 0;
  for (const TickFrame& frame : all) {
    // The edge runs along y at x = 0; the pad's centre lies under F's origin.
    if (!frame.touches || std::abs(frame.X_WF.translation.x()) > 1.5 * mm) continue;
    const Vector3 normal_W = edge.platform_normal_W(frame);
    tips.push_back(std::atan2(normal_W.x(), normal_W.z()) / deg);
    double indentation = 0.0;
    double deepest = 0.0;
    for (const Vector3& p_F : frame.samples_F) {
      const Vector3 p_W = frame.X_WF * p_F;
      // How far the skin that lies free hangs below the face that carries the rest of it.
      if (p_W.x() <= 0.0) continue;
      indentation = std::max(indentation, -p_W.z());
      deepest = std::max(deepest, -edge.device().signed_distance(frame.q, p_F).distance);
    }
    ++frames;
    if (deepest <= 0.6 * indentation) ++spared;
  }
  ASSERT_GT(frames, 20);
  EXPECT_GE(quantile(tips, 0.5), 3.0);
  EXPECT_GE(spared, 0.9 * frames);
}

TEST_P(PaperFigures, OnTheEdgeThePlatformTipsToTheFreeSideAndSparesTheSkinBeyond) {
  const Exploration edge(GetParam(), "edge");
  expect_on_edge(edge, edge.shipped());
  expect_on_edge(edge, edge.published());
}

}  // namespace
}  // namespace softfinger
