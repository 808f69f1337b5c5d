#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/csv_export.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/sqlite_database.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

RunSummary record(const fs::path& scene, const fs::path& file, double duration,
                  std::vector<std::string> trackers = {}, int threads = 1) {
  RunOptions options;
  options.scene = scene;
  options.threads = threads;
  options.trackers = std::move(trackers);
  options.duration = duration;
  options.as_fast_as_possible = true;
  options.recording = file;
  const std::atomic<bool> stop{false};
  return run_headless(options, stop);
}

std::vector<TickRecord> ticks_of(const fs::path& file) {
  RecordingReader reader(file);
  std::vector<TickRecord> ticks;
  TickRecord tick;
  while (reader.next(tick)) ticks.push_back(tick);
  return ticks;
}

TEST(Run, HeadlessTicksOnSimulatedTime) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  const RunSummary summary = record(scenes.scene("sphere"), directory / "run.db", 1.0);
  EXPECT_EQ(summary.steps, 1000);
  EXPECT_FALSE(summary.deadline_misses.has_value());
  EXPECT_EQ(summary.all.step_cpu_time.count(), 1000u);
  ASSERT_EQ(summary.fingers.size(), 1u);
  EXPECT_EQ(summary.fingers[0].first, "index");
  const std::vector<TickRecord> ticks = ticks_of(directory / "run.db");
  ASSERT_EQ(ticks.size(), 31u);
  EXPECT_GT(summary.all.commands_sent, ticks.size()) << "the device retracts at the end";
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    EXPECT_EQ(ticks[k].step,
              std::max<std::int64_t>(1, (static_cast<std::int64_t>(k) * 1000 + 29) / 30));
  }
}

/// How many steps both recordings have, all alike.
int steps_alike(const fs::path& one, const fs::path& other) {
  RecordingReader a(one);
  RecordingReader b(other);
  StepRecord step_a, step_b;
  int rows = 0;
  while (a.next(step_a)) {
    EXPECT_TRUE(b.next(step_b));
    const char* difference = first_difference(step_a, step_b);
    EXPECT_EQ(difference, nullptr) << "step " << step_a.step;
    if (difference != nullptr) break;
    ++rows;
  }
  return rows;
}

TEST(Run, TwoRunsHaveTheSameBits) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  record(scenes.scene("edge"), directory / "a.db", 2.0);
  record(scenes.scene("edge"), directory / "b.db", 2.0);
  EXPECT_EQ(steps_alike(directory / "a.db", directory / "b.db"), 2001);
}

TEST(Run, EveryStepConvergesAndForcesStayInBounds) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  const RunSummary summary = record(scenes.scene("sphere"), directory / "run.db", 3.0);
  EXPECT_EQ(summary.all.unconverged_steps, 0u);
  EXPECT_GT(summary.all.max_normal_force, 0.1);
  EXPECT_LT(summary.all.max_normal_force, 30.0);
}

class Replay : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scenes_ = std::make_unique<ScenesWithoutForceLimit>();
    directory_ = std::make_unique<TemporaryDirectory>();
    record(scenes_->scene("sphere"), *directory_ / "original.db", 2.0);
  }
  static void TearDownTestSuite() {
    directory_.reset();
    scenes_.reset();
  }

  void SetUp() override {
    fs::remove(file_);
    fs::copy_file(*directory_ / "original.db", file_);
  }
  void alter(const char* sql) {
    SqliteDatabase database(file_, SqliteDatabase::Mode::kCreate);
    database.execute(sql);
  }

  static std::unique_ptr<ScenesWithoutForceLimit> scenes_;
  static std::unique_ptr<TemporaryDirectory> directory_;
  fs::path file_ = *directory_ / "copy.db";
};
std::unique_ptr<ScenesWithoutForceLimit> Replay::scenes_;
std::unique_ptr<TemporaryDirectory> Replay::directory_;

TEST_F(Replay, Agrees) {
  const ReplayResult result = replay({.recording = file_, .scene = {}});
  EXPECT_TRUE(result.agree) << *result.first_difference << " " << result.difference;
  EXPECT_EQ(result.steps, 2000);
  EXPECT_FALSE(result.first_difference.has_value());
}

TEST_F(Replay, AgreesWithTheSceneItself) {
  EXPECT_TRUE(replay({.recording = file_, .scene = scenes_->scene("sphere")}).agree);
}

TEST_F(Replay, FindsAnotherScene) {
  const ReplayResult result = replay({.recording = file_, .scene = scenes_->scene("plane")});
  EXPECT_FALSE(result.agree);
}

TEST_F(Replay, FindsATrackedPoseAlteredByANanometre) {
  alter("update steps set y_m = y_m + 1e-9 where step = 700");
  const ReplayResult result = replay({.recording = file_, .scene = {}});
  EXPECT_FALSE(result.agree);
  EXPECT_EQ(result.first_difference, 700);
}

TEST_F(Replay, FindsARotationAlteredByTheLeastThatCounts) {
  alter("update steps set qw = qw - 1e-9 where step = 1999");
  EXPECT_EQ(replay({.recording = file_, .scene = {}}).first_difference, 1999);
}

TEST_F(Replay, FindsABonePoseAltered) {
  alter("update steps set bone_x_m = bone_x_m + 1e-9 where step = 1500");
  const ReplayResult result = replay({.recording = file_, .scene = {}});
  EXPECT_EQ(result.first_difference, 1500);
  EXPECT_THAT(result.difference, testing::HasSubstr("bone pose"));
}

TEST_F(Replay, FindsAMissingRow) {
  alter("delete from steps where step = 42");
  EXPECT_EQ(replay({.recording = file_, .scene = {}}).first_difference, 42);
}

TEST_F(Replay, NeedsNoFileButTheRecording) {
  alter(
      "update files set content = replace(cast(content as text), 'radius_mm = 20', 'radius_mm = "
      "21') "
      "where path like '%sphere.toml'");
  EXPECT_FALSE(replay({.recording = file_, .scene = {}}).agree) << "the carried scene is used";
}

TEST(LiveRun, ReplaysToTheBit) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.duration = 2.5;
  options.recording = directory / "live.db";
  LiveSession session(options, false);
  const std::atomic<bool> stop{false};
  const RunSummary summary = session.run(stop);
  EXPECT_EQ(summary.steps, 2500);
  EXPECT_TRUE(summary.deadline_misses.has_value());
  EXPECT_TRUE(RecordingReader(directory / "live.db").info().live);
  const ReplayResult result = replay({.recording = directory / "live.db", .scene = {}});
  EXPECT_TRUE(result.agree) << *result.first_difference << " " << result.difference;
}

TEST(LiveRun, PausesRestartsAndChangesScene) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.recording = directory / "live.db";
  LiveSession session(options, false);
  EXPECT_THAT(session.description()->scene_names,
              testing::IsSupersetOf({"edge", "plane", "sphere"}));
  std::atomic<bool> stop{false};
  std::thread viewer([&] {
    const auto wait = [&](const auto& condition) {
      for (int i = 0; i < 6000; ++i) {  // a minute: sanitizers are slow
        session.refresh();
        if (condition(session.latest())) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      return false;
    };
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.step > 300; }));
    session.request({LiveRequest::Kind::kPause, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.paused; }));
    const std::uint64_t step = session.latest().step;
    // Under a sanitizer no machine keeps up, and the device has retracted before.
    const bool kept_up = session.latest().fingers.at(0).device_state != "retracting";
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    session.refresh();
    EXPECT_EQ(session.latest().step, step);
    // A pause is no stall: the device holds.
    EXPECT_TRUE(!kept_up || session.latest().fingers.at(0).device_state != "retracting");
    session.request({LiveRequest::Kind::kResume, ""});
    EXPECT_TRUE(wait([&](const Snapshot& s) { return s.step > step + 300; }));
    session.request({LiveRequest::Kind::kScene, "no such scene"});
    session.request({LiveRequest::Kind::kScene, "edge"});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.generation == 2 && s.step > 100; }));
    EXPECT_EQ(session.description()->scene_name, "edge");
    stop = true;
  });
  session.run(stop);
  viewer.join();
  const ReplayResult paused = replay({.recording = directory / "live.db", .scene = {}});
  EXPECT_TRUE(paused.agree) << *paused.first_difference << " " << paused.difference;
  EXPECT_TRUE(replay({.recording = directory / "live-2.db", .scene = {}}).agree);
}

TEST(LiveRun, APauseTellsWhatTheDeviceDoesAndOutlastsRestartAndScene) {
  const ScenesWithoutForceLimit scenes;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.twin = false;
  LiveSession session(options, true);
  std::atomic<bool> stop{false};
  std::thread viewer([&] {
    bool loaded = false, ended = false;
    const auto wait = [&](const auto& condition) {
      for (int i = 0; i < 60000; ++i) {
        session.refresh();
        loaded = loaded || session.loading() == "edge";
        ended = ended || session.latest().finished;
        if (condition(session.latest())) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      return false;
    };
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.step > 300; }));
    session.request({LiveRequest::Kind::kPause, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.paused; }));
    session.request({LiveRequest::Kind::kEmergencyStop, ""});
    EXPECT_TRUE(wait(
        [](const Snapshot& s) { return s.paused && s.fingers[0].device_state == "retracting"; }));
    for (const bool restart : {true, false}) {
      const std::uint64_t generation = session.latest().generation;
      session.request({restart ? LiveRequest::Kind::kRestart : LiveRequest::Kind::kScene, "edge"});
      EXPECT_TRUE(wait([&](const Snapshot& s) { return s.generation > generation && s.paused; }));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      session.refresh();
      EXPECT_TRUE(session.latest().paused);
      EXPECT_TRUE(session.latest().emergency);
      EXPECT_EQ(session.latest().step, 0U);
    }
    EXPECT_TRUE(loaded);
    EXPECT_FALSE(ended) << "the script was cut short";
    EXPECT_EQ(session.loading(), "");
    session.request({LiveRequest::Kind::kResume, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.step > 0; }));
    stop = true;
  });
  session.run(stop);
  viewer.join();
}

TEST(LiveRun, ASceneThatCannotBeLoadedIsToldAndTheRunGoesOn) {
  const ScenesWithoutForceLimit scenes;
  std::ofstream(scenes.scene("broken")) << "title = 3\n";
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.twin = false;
  LiveSession session(options, true);
  std::atomic<bool> stop{false};
  std::vector<std::string> told;
  std::thread viewer([&] {
    session.request({LiveRequest::Kind::kScene, "broken"});
    std::optional<std::string> line;
    for (int i = 0; i < 6000 && !(line = session.take_message()); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_THAT(line.value_or(""), testing::HasSubstr("broken.toml"));
    session.refresh();
    const std::uint64_t step = session.latest().step;
    for (int i = 0; i < 6000 && session.latest().step <= step; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      session.refresh();
    }
    EXPECT_GT(session.latest().step, step);
    EXPECT_EQ(session.description()->generation, 1u);
    stop = true;
  });
  session.run(stop, {.message = [&](const std::string& line) { told.push_back(line); }});
  viewer.join();
  EXPECT_THAT(told, testing::Contains(testing::HasSubstr("broken.toml")));
}

TEST(Run, DeviceHoldsThenRetractsWhileTrackingIsLostAndResumes) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  {
    std::ofstream csv(directory / "poses.csv");
    csv << "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    for (int i = 0; i <= 300; ++i) {
      if (i > 100 && i < 200) continue;  // a second without rows
      csv << i / 100.0 << ",-3,0,45,1,0,0,0\n";
    }
  }
  record(scenes.scene("sphere"), directory / "run.db", 3.0,
         {"csv:" + (directory / "poses.csv").string()});
  bool held = false, retracted = false, resumed = false;
  for (const TickRecord& tick : ticks_of(directory / "run.db")) {
    const DeviceState state = tick.command.state;
    held = held || state == DeviceState::kHolding;
    if (state == DeviceState::kRetracting) {
      EXPECT_TRUE(held);
      EXPECT_GT(tick.time, 1.2 + 0.2);
      retracted = true;
    }
    if (tick.time > 2.5) resumed = resumed || state == DeviceState::kReady;
  }
  EXPECT_TRUE(held);
  EXPECT_TRUE(retracted);
  EXPECT_TRUE(resumed);
}

TEST(Run, EmergencyStopRetractsFromTheNextTickOn) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  std::atomic<bool> emergency{false};
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.duration = 3.0;
  options.as_fast_as_possible = true;
  options.recording = directory / "run.db";
  options.emergency_stop = &emergency;
  SceneRun::Hooks hooks;
  hooks.on_tick = [&](std::size_t, const FingerChain& chain) {
    if (chain.device().record().time > 2.0) emergency = true;
  };
  const std::atomic<bool> stop{false};
  (void)run_headless(options, stop, {}, hooks);
  int retracting = 0;
  int followed = 0;
  for (const TickRecord& tick : ticks_of(directory / "run.db")) {
    EXPECT_EQ(tick.command.state == DeviceState::kRetracting, tick.emergency) << tick.time;
    (tick.emergency ? retracting : followed) += 1;
  }
  EXPECT_GT(followed, 55);
  EXPECT_GT(retracting, 25);
  EXPECT_TRUE(replay({.recording = directory / "run.db", .scene = {}}).agree);
}

class SceneOfItsOwn : public testing::Test {
 protected:
  /// One finger a name, side by side above a plane; no device where the path is empty.
  fs::path write_scene(const std::vector<std::string>& names, const fs::path& device) {
    const fs::path root(SOFTFINGER_SOURCE_DIR);
    std::ofstream scene(directory_ / "scene.toml");
    double y = 0.0;
    for (const std::string& name : names) {
      scene << "[[finger]]\nname = \"" << name << "\"\nmodel = \""
            << (root / "fingers/index.toml").string() << "\"\n";
      if (!device.empty()) scene << "device = \"" << device.string() << "\"\n";
      scene << "tracker = \"script\"\n";
      for (const auto& [time, z] : {std::pair{0.0, 12.0}, std::pair{0.5, 6.0}}) {
        scene << "[[finger.waypoint]]\ntime_s = " << time << "\nposition_mm = [0.0, " << y << ", "
              << z << "]\nrotation_vector_deg = [0.0, 0.0, 0.0]\n";
      }
      y += 30.0;
    }
    scene << "[[object]]\nname = \"ground\"\nshape = \"plane\"\n";
    return directory_ / "scene.toml";
  }
  /// The thimble's file with another objective and more text at its end.
  [[nodiscard]] static std::string thimble_file(const fs::path& file, const std::string& objective,
                                                const std::string& more) {
    std::ifstream in(file);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string plain = "objective = \"surface\"";
    text.replace(text.find(plain), plain.size(), "objective = \"" + objective + "\"");
    return text + more;
  }
  ScenesWithoutForceLimit scenes_;
  TemporaryDirectory directory_;
};

TEST_F(SceneOfItsOwn, SeveralFingersHaveEachTheirDevice) {
  const fs::path scene = write_scene({"thumb", "index"}, scenes_.device("thimble-3rrs"));
  const RunSummary summary = record(scene, directory_ / "run.db", 0.6);
  ASSERT_EQ(summary.fingers.size(), 2u);
  EXPECT_EQ(summary.fingers[1].first, "index");
  EXPECT_EQ(summary.steps, 600);
  EXPECT_EQ(summary.all.step_cpu_time.count(), 1200u);
  EXPECT_NEAR(summary.fingers[0].second.max_normal_force,
              summary.fingers[1].second.max_normal_force, 1e-6)
      << "both do the same";
  const ReplayResult result = replay({.recording = directory_ / "run.db", .scene = {}});
  EXPECT_TRUE(result.agree) << *result.first_difference << " " << result.difference;
  RunOptions options;
  options.scene = scene;
  options.devices = {"some.toml"};
  EXPECT_THROW((void)load_setup(options), InputError) << "NAME= is needed";
}

TEST_F(SceneOfItsOwn, FingersSideBySideHaveTheSameBits) {
  const fs::path scene = write_scene({"thumb", "index", "middle"}, scenes_.device("thimble-3rrs"));
  record(scene, directory_ / "alone.db", 0.6);
  record(scene, directory_ / "shared.db", 0.6, {}, 2);
  EXPECT_EQ(steps_alike(directory_ / "alone.db", directory_ / "shared.db"), 3 * 601);
  EXPECT_TRUE(replay({.recording = directory_ / "shared.db", .scene = {}}).agree);
}

TEST_F(SceneOfItsOwn, FingerWithoutDeviceRuns) {
  const RunSummary summary = record(write_scene({"index"}, ""), directory_ / "run.db", 0.6);
  EXPECT_EQ(summary.all.commands_sent, 0u);
  EXPECT_GT(summary.all.max_normal_force, 0.0);
  EXPECT_TRUE(replay({.recording = directory_ / "run.db", .scene = {}}).agree);
  EXPECT_EQ(export_csv(directory_ / "run.db", directory_ / "csv"), "");
}

TEST_F(SceneOfItsOwn, ForceAwareMatchingReplaysToTheBit) {
  const fs::path device = directory_ / "device.toml";
  for (const std::string objective : {"surface_and_force", "stress"}) {
    std::ofstream(device) << thimble_file(scenes_.device("thimble-3rrs"), objective, "");
    const fs::path recording = directory_ / (objective + ".db").c_str();
    const RunSummary summary = record(write_scene({"index"}, device), recording, 0.6);
    EXPECT_GT(summary.all.max_normal_force, 0.1);
    const ReplayResult result = replay({.recording = recording, .scene = {}});
    EXPECT_TRUE(result.agree) << objective << ": " << result.difference;
  }
}

TEST_F(SceneOfItsOwn, MeasuredForceReplaysToTheBit) {
  const fs::path device = directory_ / "device.toml";
  std::ofstream(device) << thimble_file(scenes_.device("thimble-3rrs"), "surface",
                                        "\n[force_sensor]\nkind = \"emulator\"\nnoise_N = 0.02\n");
  const fs::path recording = directory_ / "run.db";
  record(write_scene({"index"}, device), recording, 1.2);
  double most = 0.0;
  for (const TickRecord& tick : ticks_of(recording)) {
    EXPECT_EQ(tick.reading.configuration.size(), tick.tick == 0 ? 0 : 3);
    most = std::max(most, std::abs(tick.travel_offset));
  }
  EXPECT_GT(most, 0.0) << "what is measured is made use of";
  const ReplayResult result = replay({.recording = recording, .scene = {}});
  EXPECT_TRUE(result.agree) << result.difference;
}

TEST_F(SceneOfItsOwn, ForceLimitGoesWithEveryCommand) {
  const fs::path device = directory_ / "device.toml";
  std::string text =
      thimble_file(fs::path(SOFTFINGER_SOURCE_DIR) / "devices/thimble-3rrs.toml", "surface", "");
  const std::string plain = "max_force_N = 4.7";
  ASSERT_NE(text.find(plain), std::string::npos);
  text.replace(text.find(plain), plain.size(), "max_force_N = 0.3");
  std::ofstream(device) << text;
  const fs::path recording = directory_ / "run.db";
  const RunSummary summary = record(write_scene({"index"}, device), recording, 0.6);
  EXPECT_GT(summary.all.max_normal_force, 0.3);
  int lowered = 0;
  for (const TickRecord& tick : ticks_of(recording)) {
    ASSERT_TRUE(std::isfinite(tick.command.ceiling));
    EXPECT_LE(tick.command.configuration[2], tick.command.ceiling + 1e-9);
    if (tick.wanted[2] > tick.command.configuration[2] + 0.1e-3) ++lowered;
  }
  EXPECT_GT(lowered, 0);
}

TEST_F(SceneOfItsOwn, RecordingIsNotCreatedBeforeTheRunStarts) {
  RunOptions options;
  options.scene = write_scene({"index"}, "");
  options.recording = directory_ / "run.db";
  { const LiveSession session(options, false); }
  EXPECT_FALSE(fs::exists(directory_ / "run.db"));
  std::ofstream(directory_ / "run.db") << "precious";
  EXPECT_THROW(LiveSession(options, false), InputError);
}

TEST(Run, NamesBelongToSeveralFingers) {
  const ScenesWithoutForceLimit scenes;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.trackers = {"index=csv:/no/such/file.csv"};
  const std::atomic<bool> stop{false};
  EXPECT_THROW(run_headless(options, stop), InputError);
}

}  // namespace
}  // namespace softfinger
