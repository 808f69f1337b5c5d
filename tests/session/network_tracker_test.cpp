// Poses that come over the network move the finger and the device, and what was taken of them is
// recorded, so that a replay has the same bits.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/sqlite_database.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/replay.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/tracking/natnet/natnet_emulator.hpp"
#include "softfinger/tracking/stream/osc_pose.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {
namespace {

/// Down on the ball of scenes/sphere.toml and there to stay.
Pose press_on_ball(double time) {
  const double depth = std::min(time / 0.5, 1.0) * 14.8 * mm;
  return {exp_rotation({0.0, 6.0 * deg, 0.0}), {-2.5 * mm, 0.0, 40.5 * mm - depth}};
}

std::uint16_t free_port() { return UdpSocket({kLoopback, 0}).local().port; }

class NetworkTracker : public testing::Test {
 protected:
  /// A recorded live run of 2.5 s whose tracker hears from `send` (simulated time, count) until
  /// 1.5 s.
  RunSummary run(const std::string& tracker,
                 const std::function<void(double, std::uint32_t)>& send) {
    RunOptions options;
    options.scene = scenes_.scene("sphere");
    options.trackers = {tracker};
    options.conditioning = conditioning_;
    options.duration = 2.5;
    options.actuator.port = "emulator";
    options.twin = false;
    options.recording = directory_ / "run.db";
    std::atomic<double> reached{0.0};
    RunObserver observer;
    observer.progress = [&](double time, std::optional<double>) { reached = time; };
    LiveSession session(options, false);
    std::thread sender([&] {
      for (std::uint32_t count = 0; reached < 1.5; ++count) {
        send(reached, count);
        std::this_thread::sleep_for(std::chrono::milliseconds(4));
      }
      send(1.5, 1u << 20);  // the last
    });
    const std::atomic<bool> stop{false};
    const RunSummary summary = session.run(stop, observer);
    sender.join();
    return summary;
  }

  /// What must be so of any such run.
  void expect_driven() {
    RecordingReader reader(directory_ / "run.db");
    double depth = 1.0;
    double area = 0.0;
    bool tracked = false;
    StepRecord step;
    while (reader.next(step)) {
      area = std::max(area, step.contact_area);
      if (!step.tracked.valid) continue;
      tracked = true;
      depth = std::min(depth, step.tracked.X_WFt.translation.z());
      EXPECT_LE(step.tracked.time, step.time + 1e-9) << "a pose of the future";
    }
    EXPECT_TRUE(tracked);
    EXPECT_FALSE(step.tracked.valid) << "nobody sends any more";
    EXPECT_NEAR(depth, 25.7 * mm, 0.01 * mm);
    EXPECT_GT(area, 1.0 * mm2);
    bool rendered = false, held = false;
    TickRecord tick;
    while (reader.next(tick)) {
      rendered = rendered || tick.command.state == DeviceState::kRendering;
      held = held || (rendered && tick.command.state == DeviceState::kHolding);
    }
    EXPECT_TRUE(rendered);
    EXPECT_TRUE(held);
    EXPECT_EQ(tick.command.state, DeviceState::kRetracting);
    expect_replays();
  }
  void expect_replays() {
    ReplayOptions options;
    options.recording = directory_ / "run.db";
    const ReplayResult replayed = replay(options);
    EXPECT_TRUE(replayed.agree) << replayed.difference << " in step "
                                << replayed.first_difference.value_or(-1);
    EXPECT_EQ(replayed.steps, 2500);
  }
  /// What the recording says was made of poses; from then on an earlier version could have made it.
  std::string forget_what_was_made_of_poses() {
    const std::string poses = RecordingReader(directory_ / "run.db").info().fingers.at(0).poses;
    SqliteDatabase database(directory_ / "run.db", SqliteDatabase::Mode::kCreate);
    database.execute("delete from meta where key like 'poses:%'");
    return poses;
  }

  ScenesWithoutForceLimit scenes_;
  TemporaryDirectory directory_;
  PoseConditioning conditioning_;
};

TEST_F(NetworkTracker, UdpDrivesALiveRun) {
  const std::uint16_t port = free_port();
  UdpSocket sender({kLoopback, 0});
  // The way here gets longer, to 150 ms: more than a run on a busy machine falls behind unnoticed.
  const auto send = [&](double time, std::uint32_t count) {
    Pose X_WFt = press_on_ball(time);
    // Servos that are late are seen to follow while something moves.
    X_WFt.rotation = X_WFt.rotation * exp_rotation({0.0, 4.0 * deg * std::sin(10.0 * time), 0.0});
    sender.send({kLoopback, port}, encode_pose_datagram({.X_WFt = X_WFt,
                                                         .valid = true,
                                                         .sequence = count,
                                                         .time = monotonic_time() - 0.1 * time}));
  };
  const RunSummary summary = run("udp:" + std::to_string(port), send);
  expect_driven();
  // Every stage of the way was seen, and the way to the command is made of its three.
  const FingerSummary& finger = summary.all;
  for (std::size_t i = 0; i < kLatencyStages; ++i) {
    EXPECT_GT(finger.stages.all()[i].count(), 0U) << kLatencyStageNames[i].name;
  }
  EXPECT_GT(finger.stages[LatencyStage::kExposure].max(), 50 * ms) << "150, less the run's lag";
  double to_command = 0.0;
  for (const LatencyStage stage :
       {LatencyStage::kArrival, LatencyStage::kStep, LatencyStage::kMatch}) {
    EXPECT_GE(finger.latency.max(), finger.stages[stage].max());
    to_command += finger.stages[stage].max();
  }
  EXPECT_LE(finger.latency.max(), to_command);
}

TEST_F(NetworkTracker, OscDrivesALiveRun) {
  const std::uint16_t port = free_port();
  UdpSocket sender({kLoopback, 0});
  run("osc:" + std::to_string(port), [&](double time, std::uint32_t) {
    sender.send({kLoopback, port}, encode_osc_pose(press_on_ball(time), false));
  });
  expect_driven();
}

// A replay takes the poses that steps took, whatever was made of them and by which version.
TEST_F(NetworkTracker, ARecordingSaysWhatWasMadeOfPosesAndReplaysWithoutIt) {
  for (const bool predicts : {false, true}) {
    std::filesystem::remove(directory_ / "run.db");
    if (predicts) conditioning_ = {.filter = OneEuroSettings{}, .lead = 20 * ms};
    const std::uint16_t port = free_port();
    UdpSocket sender({kLoopback, 0});
    run("osc:" + std::to_string(port), [&](double time, std::uint32_t) {
      sender.send({kLoopback, port}, encode_osc_pose(press_on_ball(time), true));
    });
    expect_replays();
    EXPECT_EQ(forget_what_was_made_of_poses(),
              predicts ? "filtered, carried on by 20 ms" : "interpolated");
    EXPECT_EQ(forget_what_was_made_of_poses(), "");
    expect_replays();
  }
}

TEST_F(NetworkTracker, NatNetDrivesALiveRunThroughLossAndDisorder) {
  std::atomic<double> reached{0.0};
  NatNetEmulator emulator({.loss = 0.3, .duplication = 0.1, .reordering = 0.2}, [&](double) {
    return TrackedPose{.X_WFt = press_on_ball(reached), .valid = reached < 1.5};
  });
  run("natnet:" + text_of(emulator.address()) + ",body=index",
      [&](double time, std::uint32_t) { reached = time; });
  expect_driven();
}

TEST_F(NetworkTracker, ARunAsFastAsPossibleIsRefused) {
  RunOptions options;
  options.scene = scenes_.scene("sphere");
  options.trackers = {"udp:" + std::to_string(free_port())};
  options.duration = 0.1;
  options.as_fast_as_possible = true;
  const std::atomic<bool> stop{false};
  EXPECT_THROW((void)run_headless(options, stop), InputError);
  options.as_fast_as_possible = false;
  EXPECT_EQ(run_headless(options, stop).steps, 100);
}

}  // namespace
}  // namespace softfinger
