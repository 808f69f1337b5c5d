// Whole hands of a scene: recorded, replayed to the bit, and moved by a headset.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "recorded_run.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/sqlite_database.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

/// A hand that comes down on a ball, with one soft finger.
class HandRun : public testing::Test {
 protected:
  HandRun() {
    std::ofstream scene(scene_);
    scene << "[[hand]]\nforce_limit_N = 5.0\n";
    for (const char* at : {"0.0\nposition_mm = [-80, 5, 60]", "0.2\nposition_mm = [-80, 5, 36]"}) {
      scene << "[[hand.waypoint]]\ntime_s = " << at << "\nindex_deg = [0, 20, 30]\n";
    }
    scene << "[[finger]]\nname = \"index\"\nhand = \"right\"\nmodel = \""
          << (fs::path(source_folder()) / "fingers/index.toml").string()
          << "\"\n[[object]]\nname = \"ball\"\nshape = \"sphere\"\nradius_mm = 15.0\n"
             "motion = \"dynamic\"\nmass_g = 40.0\nposition_mm = [0, 5, 15]\n"
             "[[object]]\nname = \"table\"\nshape = \"plane\"\n";
  }
  /// Of the recording's last row of this object.
  [[nodiscard]] ObjectRecord last_of(std::int64_t object) const {
    RecordingReader reader(file_);
    ObjectRecord row, last;
    while (reader.next(row)) {
      if (row.object == object) last = row;
    }
    return last;
  }

  TemporaryDirectory directory_;
  fs::path scene_ = directory_ / "scene.toml";
  fs::path file_ = directory_ / "run.db";
};

TEST_F(HandRun, ReplaysToTheBitAndNoticesABoneTrackedElsewhere) {
  const RunSummary summary = record(scene_, file_, 0.3);
  EXPECT_EQ(summary.all.unconverged_steps, 0U);
  const ReplayResult same = replay({.recording = file_, .scene = {}});
  EXPECT_TRUE(same.agree) << *same.first_difference << " " << same.difference;
  EXPECT_EQ(same.steps, 300);
  // Its palm has pressed the ball.
  EXPECT_GT((last_of(0).X_WO.translation - Vector3(0.0, 5e-3, 15e-3)).norm(), 20e-6);
  {
    SqliteDatabase database(file_, SqliteDatabase::Mode::kCreate);
    database.execute("update bones set y_m = y_m + 1e-9 where step = 150 and object = 5");
  }
  const ReplayResult other = replay({.recording = file_, .scene = {}});
  EXPECT_EQ(other.first_difference, 150);
}

TEST_F(HandRun, HasARowWhereABoneIsTrackedElsewhereAlone) {
  record(scene_, file_, 0.3);
  RecordingReader reader(file_);
  FollowRecord bone;
  std::int64_t rows = 0, last = 0;
  while (reader.next(bone)) {
    ++rows;
    last = bone.step;
    EXPECT_TRUE(bone.valid);
  }
  EXPECT_EQ(last, 200) << "still from there";
  EXPECT_LE(rows, 201 * 14);
  EXPECT_GT(rows, 190 * 14);
}

TEST_F(HandRun, NobodyWearsAHeadsetInAHeadlessRun) {
  std::ofstream(scene_) << "[[hand]]\ntracker = \"webxr\"\n";
  RunOptions options;
  options.scene = scene_;
  options.duration = 0.01;
  const std::atomic<bool> stop{false};
  try {
    (void)run_headless(options, stop);
    ADD_FAILURE() << "it ran";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("hand right"));
  }
}

TEST_F(HandRun, AHeadsetMovesItAndThatReplaysToTheBit) {
  RunOptions options;
  options.scene = scene_;
  options.trackers = {"webxr"};
  options.recording = file_;
  LiveSession session(options, false);
  std::atomic<bool> stop{false};
  std::thread running([&] { (void)session.run(stop); });
  XrHand hand{.tracked = true};
  for (std::size_t k = 0; k < kXrJointCount; ++k) {
    hand.joints[k].position = {0.01F * static_cast<float>(k % 5), 0.1F, -0.02F};
  }
  const std::size_t bone = 2;  // behind ball and table: the thumb's metacarpal
  const Vector3 wanted(0.02, -0.015, 0.1);
  double away = 1.0;
  for (int frame = 1; frame < 2000 && away > 1e-3; ++frame) {
    hand.time = 0.01 * frame;
    session.offer_hand(hand);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (!session.refresh()) continue;
    away = (session.latest().X_WO[bone].translation - wanted).norm();
  }
  EXPECT_LT(away, 1e-3);
  stop.store(true);
  running.join();
  const ReplayResult result = replay({.recording = file_, .scene = {}});
  EXPECT_TRUE(result.agree) << *result.first_difference << " " << result.difference;
}

}  // namespace
}  // namespace softfinger
