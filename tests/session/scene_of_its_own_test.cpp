#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "recorded_run.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/csv_export.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

class SceneOfItsOwn : public testing::Test {
 protected:
  /// One finger a name, side by side above a plane; no device where the path is empty.
  fs::path write_scene(const std::vector<std::string>& names, const fs::path& device) {
    const fs::path root(source_folder());
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
    const std::string plain = "objective = \"surface_and_force\"";
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
  std::vector<double> offsets[2];
  for (const bool refine : {false, true}) {
    const std::string sensor = "\n[force_sensor]\nkind = \"emulator\"\nnoise_N = 0.02\n";
    std::ofstream(device) << thimble_file(scenes_.device("thimble-3rrs"), "surface",
                                          sensor + (refine ? "refine = true\n" : ""));
    const fs::path recording = directory_ / (refine ? "refined.db" : "run.db");
    record(write_scene({"index"}, device), recording, 1.2);
    for (const TickRecord& tick : ticks_of(recording)) {
      EXPECT_EQ(tick.reading.configuration.size(), tick.tick == 0 ? 0 : 3);
      offsets[refine ? 1 : 0].push_back(std::abs(tick.travel_offset));
    }
    EXPECT_GT(std::ranges::max(offsets[refine ? 1 : 0]), 0.0) << "what is measured is made use of";
    const ReplayResult result = replay({.recording = recording, .scene = {}});
    EXPECT_TRUE(result.agree) << result.difference;
  }
  EXPECT_NE(offsets[0], offsets[1]) << "to refine is something else";
}

TEST_F(SceneOfItsOwn, ForceLimitGoesWithEveryCommand) {
  const fs::path device = directory_ / "device.toml";
  std::string text =
      thimble_file(fs::path(source_folder()) / "devices/thimble-3rrs.toml", "surface", "");
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

}  // namespace
}  // namespace softfinger
