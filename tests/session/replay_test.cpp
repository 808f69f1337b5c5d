#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "recorded_run.hpp"
#include "softfinger/recording/sqlite_database.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

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

}  // namespace
}  // namespace softfinger
