#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <thread>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "recorded_run.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/csv_export.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

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

TEST(Run, AStopRetractsFromTheNextTickOn) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  StopSignals signals;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.duration = 3.0;
  options.as_fast_as_possible = true;
  options.recording = directory / "run.db";
  options.stop_signals = &signals;
  SceneRun::Hooks hooks;
  hooks.on_tick = [&](std::size_t, const FingerChain& chain) {
    if (chain.device().record().time > 2.0) signals.stops = 1;
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

TEST(Run, ItsRecordingHasWhoStoppedADeviceWhoReleasedItAndWhen) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  StopSignals signals;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.duration = 4.0;
  options.as_fast_as_possible = true;
  options.recording = directory / "run.db";
  options.stop_signals = &signals;
  SceneRun::Hooks hooks;
  hooks.on_tick = [&](std::size_t, const FingerChain& chain) {
    if (chain.device().record().time > 1.0) signals.stops = 1;
    if (chain.device().record().time > 3.0) signals.releases = 1;
    // What is told is looked for every few milliseconds, and this run does not wait for the clock.
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  };
  const std::atomic<bool> stop{false};
  std::vector<std::string> told;
  (void)run_headless(options, stop,
                     {.message = [&](const std::string& line) { told.push_back(line); }}, hooks);
  const std::vector<RecordedMessage> messages = RecordingReader(directory / "run.db").messages();
  ASSERT_EQ(messages.size(), 2U);
  ASSERT_EQ(told.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(messages[i].text, told[i]);
  EXPECT_NE(messages[0].text.find("stopped by a signal"), std::string::npos);
  EXPECT_NE(messages[1].text.find("released by a signal"), std::string::npos);
  EXPECT_GE(messages[0].time, 1.0);
  EXPECT_GE(messages[1].time, 3.0);
  EXPECT_EQ(static_cast<double>(messages[1].step), std::round(1000.0 * messages[1].time));
  EXPECT_GT(messages[1].since_start, messages[0].since_start);
  ASSERT_EQ(export_csv(directory / "run.db", directory / "csv"), "");
  std::ifstream csv(directory / "csv/messages.csv");
  const std::string text{std::istreambuf_iterator<char>(csv), {}};
  EXPECT_EQ(text.find("time_s,since_start_s,message\n"), 0U);
  for (const std::string& line : told) EXPECT_NE(text.find(line), std::string::npos);
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
