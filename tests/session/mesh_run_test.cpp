#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "../support/folders.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
const fs::path kSource = source_folder();

/// A scene of its own that strokes the relief, a copy of it beside.
class MeshRun : public testing::Test {
 protected:
  MeshRun() {
    fs::copy_file(kSource / "objects" / "relief.ply", directory_ / "relief.ply");
    std::ifstream in(kSource / "scenes" / "relief.toml");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto replace = [&text](const std::string& from, const std::string& to) {
      ASSERT_NE(text.find(from), std::string::npos) << from;
      text.replace(text.find(from), from.size(), to);
    };
    replace("../objects/", "");
    // A coarse grid, which is built in a moment.
    replace("shape = \"mesh\"", "shape = \"mesh\"\nedge_rounding_mm = 2.0");
    replace("../fingers", (kSource / "fingers").string());
    replace("../devices/thimble-3rrs.toml", scenes_.device("thimble-3rrs").string());
    std::ofstream(directory_ / "scene.toml") << text;
    RunOptions options;
    options.scene = directory_ / "scene.toml";
    options.duration = 1.6;
    options.as_fast_as_possible = true;
    options.recording = directory_ / "run.db";
    const std::atomic<bool> stop{false};
    summary_ = run_headless(options, stop);
  }

  ScenesWithoutForceLimit scenes_;
  TemporaryDirectory directory_;
  RunSummary summary_;
};

TEST_F(MeshRun, TouchesAndReplaysToTheBit) {
  EXPECT_GT(summary_.all.max_contact_area, 5e-6);
  EXPECT_GT(summary_.all.max_normal_force, 0.1);
  const RecordingInfo info = RecordingReader(directory_ / "run.db").info();
  ASSERT_EQ(info.meshes.size(), 1u);
  EXPECT_EQ(info.meshes[0].path, directory_ / "relief.ply");
  // Built anew or from the cache: no difference.
  EXPECT_TRUE(replay({.recording = directory_ / "run.db"}).agree);
  fs::remove_all(directory_ / ".softfinger-cache");
  EXPECT_TRUE(replay({.recording = directory_ / "run.db"}).agree);
}

TEST_F(MeshRun, ReplayRefusesAnotherMesh) {
  std::fstream mesh(directory_ / "relief.ply", std::ios::in | std::ios::out | std::ios::binary);
  mesh.seekp(2000);
  mesh.put('\x40');
  mesh.close();
  try {
    (void)replay({.recording = directory_ / "run.db"});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("another content of"));
    EXPECT_THAT(error.what(), testing::HasSubstr("relief.ply"));
  }
  fs::remove(directory_ / "relief.ply");
  EXPECT_THROW((void)replay({.recording = directory_ / "run.db"}), InputError);
}

}  // namespace
}  // namespace softfinger
