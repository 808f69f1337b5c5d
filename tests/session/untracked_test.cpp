// Before its first valid pose a finger is nowhere, whatever stands where it waits: it touches
// nothing, bears nothing, and its device is at home and then retracted.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>

#include "../support/folders.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/replay.hpp"
#include "softfinger/tracking/natnet/natnet_emulator.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr double kFirstRow = 0.3;  // s, of the file of poses

class Untracked : public testing::Test {
 protected:
  Untracked() {
    options_.scene = directory_ / "scene.toml";
    options_.actuator.port = "emulator";
    options_.twin = false;
    options_.recording = directory_ / "run.db";
    std::ofstream poses(directory_ / "poses.csv");
    poses << "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    for (int row = 0; row < 60; ++row) {
      poses << kFirstRow + 0.01 * row << ",0,0,105.5,0.998629534754574,0,0.052335956242944,0\n";
    }
  }
  /// A block of 200 mm around the origin, and one finger for each tracker, without waypoints: where
  /// they wait is in the middle of it.
  void write_scene(const std::vector<std::string>& trackers) {
    std::ofstream scene(options_.scene);
    for (std::size_t i = 0; i < trackers.size(); ++i) {
      scene << "[[finger]]\nname = \"f" << i << "\"\nmodel = \""
            << (fs::path(source_folder()) / "fingers/index.toml").string() << "\"\ndevice = \""
            << scenes_.device("thimble-3rrs").string() << "\"\ntracker = \"" << trackers[i]
            << "\"\n";
    }
    scene << "[[object]]\nname = \"block\"\nshape = \"box\"\nsize_mm = [200.0, 200.0, 200.0]\n";
  }
  std::string late_file() const { return "csv:" + (directory_ / "poses.csv").string(); }

  /// Before each finger's first valid pose; how many steps that were, by finger.
  std::map<std::int64_t, int> expect_nowhere(const Device& device) {
    std::map<std::int64_t, int> waited;
    std::map<std::int64_t, bool> seen;
    RecordingReader reader(*options_.recording);
    StepRecord step;
    while (reader.next(step)) {
      if (step.tracked.valid) seen[step.finger] = true;
      if (seen[step.finger]) {
        pressed_ = std::max(pressed_, step.normal_force);
        continue;
      }
      ++waited[step.finger];
      EXPECT_EQ(step.normal_force, 0.0) << "finger " << step.finger << ", step " << step.step;
      EXPECT_EQ(step.tangential_force, 0.0);
      EXPECT_EQ(step.contact_area, 0.0);
      EXPECT_EQ(step.contact_count, 0);
      EXPECT_TRUE(std::isinf(step.least_gap) && step.least_gap > 0.0);
    }
    TickRecord tick;
    while (reader.next(tick)) {
      if (seen[tick.finger]) continue;
      EXPECT_EQ((tick.wanted - device.home()).norm(), 0.0) << tick.time;
      EXPECT_NE(tick.command.state, DeviceState::kRendering);
      last_state_[tick.finger] = tick.command.state;
    }
    return waited;
  }

  ScenesWithoutForceLimit scenes_;
  TemporaryDirectory directory_;
  RunOptions options_;
  double pressed_ = 0.0;  ///< N, most of any finger that was seen
  std::map<std::int64_t, DeviceState> last_state_;
};

// All at once, one finger each; the file of poses begins late, its finger on top of the block.
TEST_F(Untracked, WhateverTheTracker) {
  NatNetEmulator emulator({}, [](double) { return TrackedPose{}; });
  const auto port = [] { return std::to_string(UdpSocket({kLoopback, 0}).local().port); };
  const std::vector<std::string> trackers{
      "udp:" + port(), "osc:" + port(), "natnet:" + text_of(emulator.address()) + ",body=index",
      "webxr:thumb",   "page",          late_file()};
  write_scene(trackers);
  for (const bool with_prediction : {false, true}) {
    if (with_prediction) options_.conditioning = {.filter = OneEuroSettings{}, .lead = 0.02};
    options_.duration = 0.6;
    LiveSession session(options_, false);
    const std::atomic<bool> stop{false};
    const RunSummary summary = session.run(stop);
    const auto waited = expect_nowhere(*load_setup(options_)->devices.at(0));
    for (std::int64_t finger = 0; finger < 5; ++finger) {
      EXPECT_EQ(waited.at(finger), 601) << trackers[static_cast<std::size_t>(finger)];
      EXPECT_EQ(last_state_.at(finger), DeviceState::kRetracting);
      EXPECT_EQ(summary.fingers[static_cast<std::size_t>(finger)].second.max_normal_force, 0.0);
    }
    EXPECT_EQ(waited.at(5), std::lround(kFirstRow * 1000));
    EXPECT_GT(pressed_, 0.1) << "the block is there, or this test shows nothing";
    // It appears half a millimetre deep and must give way at once: no more than a hard tap.
    EXPECT_LT(pressed_, 30.0);
    fs::remove(*options_.recording);
  }
}

TEST_F(Untracked, AReplayHasTheSameBits) {
  write_scene({late_file()});
  options_.as_fast_as_possible = true;
  const std::atomic<bool> stop{false};
  (void)run_headless(options_, stop);
  EXPECT_EQ(expect_nowhere(*load_setup(options_)->devices.at(0)).at(0), 300);
  EXPECT_GT(pressed_, 0.1);
  const ReplayResult replayed = replay({.recording = *options_.recording, .scene = {}});
  EXPECT_TRUE(replayed.agree) << replayed.difference;
}

}  // namespace
}  // namespace softfinger
