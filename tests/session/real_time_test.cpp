#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "loop_guard.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kShippedScenes = std::filesystem::path(source_folder()) / "scenes";

class RealTimePath : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!guard_works()) GTEST_SKIP() << "not with a sanitizer's own malloc";
    reset_guard();
    options_.scene = kShippedScenes / GetParam();
    options_.recording = directory_ / "run.db";
  }
  SceneRun::Hooks hooks_{.on_loop_thread = guard_this_thread};
  std::atomic<bool> stop_{false};
  TemporaryDirectory directory_;
  RunOptions options_;
};

TEST(LoopGuard, Counts) {
  if (!guard_works()) GTEST_SKIP() << "not with a sanitizer's own malloc";
  reset_guard();
  std::thread([] {
    guard_this_thread();
    std::vector<int> some(10);
    some.resize(1000);
    std::mutex mutex;
    const std::lock_guard lock(mutex);
  }).join();
  EXPECT_GE(guard_counts().allocations, 2u);
  EXPECT_GE(guard_counts().locks, 1u);
  EXPECT_EQ(guard_counts().threads, 1u);
}

TEST_P(RealTimePath, HeadlessNeitherAllocatesNorLocks) {
  options_.duration = 8.0;
  options_.as_fast_as_possible = true;
  options_.record_state = true;
  const RunSummary summary = run_headless(options_, stop_, {}, hooks_);
  EXPECT_EQ(summary.steps, 8000);
  EXPECT_GT(summary.all.max_contact_area, 0.0) << "something is touched";
  EXPECT_EQ(guard_counts().threads, 1u);
  EXPECT_EQ(guard_counts().allocations, 0u);
  EXPECT_EQ(guard_counts().locks, 0u);
}

class RealTimePathOfMovingObjects : public RealTimePath {};

TEST_P(RealTimePathOfMovingObjects, NeitherAllocatesNorLocks) {
  options_.as_fast_as_possible = true;
  // Held by then, and in the test's time.
  if (options_.scene.stem() == "bottle") options_.duration = 1.7;
  if (options_.scene.stem() == "sponge") options_.duration = 2.0;
  const RunSummary summary = run_headless(options_, stop_, {}, hooks_);
  EXPECT_GT(summary.all.max_contact_area, 0.0) << "something is touched";
  ASSERT_FALSE(summary.objects.empty());
  EXPECT_EQ(guard_counts().allocations, 0u);
  EXPECT_EQ(guard_counts().locks, 0u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, RealTimePathOfMovingObjects,
                         testing::Values("cup.toml", "tower.toml", "button.toml", "sponge.toml",
                                         "bottle.toml"),
                         [](const auto& scene) {
                           const std::string name = scene.param;
                           return name.substr(0, name.find('.'));
                         });

TEST_P(RealTimePath, ForceAwareMatchingNeitherAllocatesNorLocks) {
  for (const std::string objective : {"surface_and_force", "stress"}) {
    reset_guard();
    options_.duration = 3.0;
    options_.as_fast_as_possible = true;
    options_.objective = objective_kind(objective);
    options_.recording = directory_ / (objective + ".db").c_str();
    const RunSummary summary = run_headless(options_, stop_, {}, hooks_);
    EXPECT_GT(summary.all.max_contact_area, 0.0) << "something is touched";
    EXPECT_EQ(guard_counts().allocations, 0u);
    EXPECT_EQ(guard_counts().locks, 0u);
  }
}

TEST_P(RealTimePath, LiveNeitherAllocatesNorLocks) {
  options_.duration = 3.0;
  LiveSession session(options_, false, hooks_);
  const RunSummary summary = session.run(stop_);
  EXPECT_EQ(summary.steps, 3000);
  EXPECT_EQ(guard_counts().threads, 2u) << "simulation and device";
  EXPECT_EQ(guard_counts().allocations, 0u);
  EXPECT_EQ(guard_counts().locks, 0u);
}

TEST_P(RealTimePath, PosesOverTheNetworkNeitherAllocateNorLock) {
  const std::uint16_t port = UdpSocket({kLoopback, 0}).local().port;
  options_.trackers = {"udp:" + std::to_string(port)};
  options_.duration = 2.0;
  options_.twin = false;
  LiveSession session(options_, false, hooks_);
  std::atomic<bool> ended{false};
  std::thread sender([&] {
    UdpSocket socket({kLoopback, 0});
    for (std::uint32_t count = 0; !ended; ++count) {
      const double time = monotonic_time();
      const Pose X_WFt{Matrix3::Identity(), {0.002 * std::sin(time), 0.0, 0.0257}};
      socket.send(
          {kLoopback, port},
          encode_pose_datagram({.X_WFt = X_WFt, .valid = true, .sequence = count, .time = time}));
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
    }
  });
  const RunSummary summary = session.run(stop_);
  ended = true;
  sender.join();
  EXPECT_GT(summary.all.pose_age.percentile(50.0), 1e-3) << "s: poses came";
  EXPECT_EQ(guard_counts().allocations, 0u);
  EXPECT_EQ(guard_counts().locks, 0u);
}

/// Helpers share the step of one large finger or step small ones side by side.
class RealTimeHelpers : public testing::Test {
 protected:
  void SetUp() override {
    if (!guard_works()) GTEST_SKIP() << "not with a sanitizer's own malloc";
    reset_guard();
    options_.threads = 2;
    options_.scene = directory_ / "scene.toml";
  }
  /// Fingers that press a plane and leave it again within a second.
  void write_scene(const std::string& model, int fingers) {
    std::ofstream scene(options_.scene);
    for (int f = 0; f < fingers; ++f) {
      scene << "[[finger]]\nname = \"finger-" << f << "\"\nmodel = \""
            << (std::filesystem::path(source_folder()) / "fingers" / model).string()
            << "\"\ndevice = \""
            << (std::filesystem::path(source_folder()) / "devices/thimble-3rrs.toml").string()
            << "\"\ntracker = \"script\"\n";
      for (const auto& [time, z] :
           {std::pair{0.0, 9.0}, std::pair{0.5, 6.0}, std::pair{1.0, 9.0}}) {
        scene << "[[finger.waypoint]]\ntime_s = " << time << "\nposition_mm = [0.0, " << 30 * f
              << ", " << z << "]\nrotation_vector_deg = [0.0, 0.0, 0.0]\n";
      }
    }
    scene << "[[object]]\nname = \"ground\"\nshape = \"plane\"\n";
  }
  void expect_nothing(const RunSummary& summary, std::uint64_t threads) {
    EXPECT_EQ(summary.steps, 1000);
    EXPECT_GT(summary.all.max_normal_force, 0.1) << "something is touched";
    EXPECT_EQ(guard_counts().threads, threads);
    EXPECT_EQ(guard_counts().allocations, 0u);
    EXPECT_EQ(guard_counts().locks, 0u);
  }
  SceneRun::Hooks hooks_{.on_loop_thread = guard_this_thread};
  std::atomic<bool> stop_{false};
  TemporaryDirectory directory_;
  RunOptions options_;
};

TEST_F(RealTimeHelpers, OfALargeFingerNeitherAllocateNorLock) {
  options_.as_fast_as_possible = true;
  write_scene("index-medium.toml", 1);
  expect_nothing(run_headless(options_, stop_, {}, hooks_), 2);
}

TEST_F(RealTimeHelpers, OfSeveralFingersNeitherAllocateNorLock) {
  options_.as_fast_as_possible = true;
  write_scene("index.toml", 3);
  expect_nothing(run_headless(options_, stop_, {}, hooks_), 2);
}

TEST_F(RealTimeHelpers, LiveNeitherAllocateNorLock) {
  write_scene("index-medium.toml", 1);
  LiveSession session(options_, false, hooks_);
  expect_nothing(session.run(stop_), 3);  // with the device's
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, RealTimePath, testing::Values("sphere.toml", "edge.toml"), [](const auto& scene) {
      return std::string(scene.param).substr(0, std::string(scene.param).find('.'));
    });

}  // namespace
}  // namespace softfinger
