// A scene loads, the first one or another while a run goes on: what else is asked for does not wait
// for it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "../support/child_process.hpp"
#include "../support/environment_variable.hpp"
#include "../support/folders.hpp"
#include "../support/large_mesh.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/scene_load.hpp"

namespace softfinger {
namespace {

using namespace std::chrono_literals;

/// A session whose page asks for a scene with a mesh that is never imported to its end.
class SceneThatLoads : public testing::Test {
 protected:
  SceneThatLoads() {
    std::ifstream in(scenes_.scene("relief"));
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string shipped = "../objects/relief.ply";
    text.replace(text.find(shipped), shipped.size(), "large.obj");
    std::ofstream(scenes_.scene("endless")) << text;
    std::ofstream(scenes_.scene("x").parent_path() / "large.obj") << text_of_large_mesh();
    options_.scene = scenes_.scene("sphere");
    options_.twin = false;
  }

  /// Runs the session, and `page` beside it until it returns.
  void run(bool repeat, const std::function<void(LiveSession&)>& page) {
    LiveSession session(options_, repeat);
    std::thread viewer([&] {
      page(session);
      stopped_ = std::chrono::steady_clock::now();
      stop_ = true;
    });
    session.run(stop_);
    const auto ended = std::chrono::steady_clock::now();
    viewer.join();
    took_ = ended - stopped_;
  }
  /// Asks for it, and stops the process that imports its mesh: it takes no time, and no end.
  static void load_endless(LiveSession& session) {
    session.request({LiveRequest::Kind::kScene, "endless"});
    const pid_t import = child_of(::getpid());
    ASSERT_GT(import, 0);
    ASSERT_EQ(::kill(import, SIGSTOP), 0);
    EXPECT_EQ(session.loading(), "endless");
  }
  static bool wait(LiveSession& session, const std::function<bool(const Snapshot&)>& condition) {
    for (int i = 0; i < 6000; ++i) {  // a minute: sanitizers are slow
      session.refresh();
      if (condition(session.latest())) return true;
      std::this_thread::sleep_for(10ms);
    }
    return false;
  }

  ScenesWithoutForceLimit scenes_;
  RunOptions options_;
  std::atomic<bool> stop_{false};
  std::chrono::steady_clock::time_point stopped_;
  std::chrono::steady_clock::duration took_{};
};

TEST_F(SceneThatLoads, EndsTheFirstTimeAsSoon) {
  options_.scene = scenes_.scene("endless");
  std::thread person([&] {
    const pid_t import = child_of(::getpid());
    EXPECT_GT(import, 0);
    EXPECT_EQ(::kill(import, SIGSTOP), 0);
    stopped_ = std::chrono::steady_clock::now();
    stop_ = true;
  });
  const RunSummary summary = run_headless(options_, stop_);
  const auto ended = std::chrono::steady_clock::now();
  person.join();
  took_ = ended - stopped_;
  EXPECT_LT(took_, 10s);
  EXPECT_EQ(summary.steps, 0);
  EXPECT_TRUE(summary.fingers.empty());
}

// A finger's mesh and the table of a device's force limit take their time as well.
TEST(FirstLoad, EndsAmongFingersAndDevices) {
  const TemporaryDirectory nothing_kept;
  const EnvironmentVariable caches("XDG_CACHE_HOME", nothing_kept / "caches");
  RunOptions options;
  options.scene = std::filesystem::path(source_folder()) / "scenes/hand.toml";
  std::atomic<bool> stop{false};
  std::chrono::steady_clock::time_point stopped;
  std::thread person([&] {
    std::this_thread::sleep_for(150ms);
    stopped = std::chrono::steady_clock::now();
    stop = true;
  });
  EXPECT_EQ(load_unless_stopped(options, stop), nullptr);
  const auto ended = std::chrono::steady_clock::now();
  person.join();
  EXPECT_LT(ended - stopped, 5s);
  EXPECT_EQ(load_unless_stopped(options, stop), nullptr);
  options.scene = "no such scene";
  stop = false;
  EXPECT_THROW(static_cast<void>(load_unless_stopped(options, stop)), InputError);
}

TEST_F(SceneThatLoads, DoesNotKeepAProgramFromEnding) {
  run(true, [](LiveSession& session) { load_endless(session); });
  EXPECT_LT(took_, 10s);
}

TEST_F(SceneThatLoads, ARunGoesOnAndPausesMeanwhile) {
  run(true, [](LiveSession& session) {
    load_endless(session);
    const std::uint64_t step = session.latest().step;
    EXPECT_TRUE(wait(session, [&](const Snapshot& s) { return s.step > step + 100; }));
    session.request({LiveRequest::Kind::kPause, ""});
    EXPECT_TRUE(wait(session, [](const Snapshot& s) { return s.paused; }));
    session.request({LiveRequest::Kind::kResume, ""});
    EXPECT_TRUE(wait(session, [](const Snapshot& s) { return !s.paused; }));
    EXPECT_EQ(session.loading(), "endless");
    EXPECT_EQ(session.description()->generation, 1U);
  });
  EXPECT_LT(took_, 10s);
}

TEST_F(SceneThatLoads, GivesWayToTheNextOne) {
  run(true, [](LiveSession& session) {
    load_endless(session);
    session.request({LiveRequest::Kind::kScene, "no such scene"});
    std::this_thread::sleep_for(300ms);
    EXPECT_EQ(session.loading(), "endless");
    session.request({LiveRequest::Kind::kScene, "plane"});
    EXPECT_TRUE(wait(session, [](const Snapshot& s) { return s.generation == 2 && s.step > 10; }));
    EXPECT_EQ(session.description()->scene_name, "plane");
    EXPECT_EQ(session.loading(), "");
    // Of what was given up nobody is told. A slow machine may have let the device wait.
    for (auto said = session.take_message(); said; said = session.take_message()) {
      EXPECT_THAT(*said, testing::StartsWith("no command for"));
    }
  });
}

TEST_F(SceneThatLoads, OutlastsAScriptThatEndsMeanwhile) {
  options_.duration = 0.5;
  run(false, [](LiveSession& session) {
    load_endless(session);
    EXPECT_TRUE(wait(session, [](const Snapshot& s) { return s.finished; }));
    std::this_thread::sleep_for(600ms);
    session.request({LiveRequest::Kind::kScene, "plane"});
    EXPECT_TRUE(wait(session, [](const Snapshot& s) { return s.generation == 2; }));
  });
}

}  // namespace
}  // namespace softfinger
