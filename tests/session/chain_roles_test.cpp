// The chain that a scene's files describe, stepped by hand, does what a run of the scene records.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/replay.hpp"
#include "softfinger/session/run_tracker.hpp"

namespace softfinger {
namespace {

TEST(ChainRoles, RunReplayAndStepsByHandAgree) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  RunOptions options;
  options.scene = scenes.scene("edge");
  options.duration = 2.0;
  options.as_fast_as_possible = true;
  options.recording = directory / "run.db";
  options.record_state = true;
  const std::shared_ptr<const RunSetup> setup = load_setup(options);
  const std::atomic<bool> stop{false};
  const RunSummary summary = run_headless(setup, options, stop);
  EXPECT_GT(summary.all.max_normal_force, 0.1) << "N, or nothing is rendered";
  EXPECT_TRUE(replay({.recording = directory / "run.db", .scene = {}}).agree);

  FingerChainOptions chain_of = chain_options(*setup, 0, {.simulated_time = true});
  chain_of.with_state = true;
  FingerChain chain(chain_of);
  RunTracker tracker(*setup, 0, options, false);
  RecordingReader reader(directory / "run.db");
  StepRecord step;
  TickRecord tick;
  std::size_t ticks = 0;
  for (std::int64_t n = 0; n <= summary.steps; ++n) {
    const TrackedInput tracked(
        tracker.sample(static_cast<double>(n) / setup->scene.simulation_rate));
    if (n == 0) {
      chain.start(tracked);
    } else {
      chain.step(n, tracked);
    }
    if (chain.tick_is_due()) {
      ASSERT_TRUE(reader.next(tick));
      const char* difference =
          first_difference(tick, chain.tick(chain.tick_input(std::chrono::steady_clock::now())));
      ASSERT_EQ(difference, nullptr) << difference << " of tick " << tick.tick;
      ++ticks;
    }
    ASSERT_TRUE(reader.next(step));
    const StepRecord& sealed = chain.seal();
    const char* difference = first_difference(step, sealed);
    ASSERT_EQ(difference, nullptr) << difference << " of step " << n;
    ASSERT_EQ(step.nodes_W, sealed.nodes_W);
  }
  EXPECT_FALSE(reader.next(step));
  EXPECT_FALSE(reader.next(tick));
  EXPECT_EQ(ticks, summary.all.ticks);
}

// The page may go on offering poses to a run that has ended; its ports are free all the same.
TEST(ChainRoles, AClosedTrackerStillTakesWhatThePageOffers) {
  const ScenesWithoutForceLimit scenes;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.trackers = {"page"};
  const std::shared_ptr<const RunSetup> setup = load_setup(options);
  RunTracker tracker(*setup, 0, options, true);
  const Pose offered{Matrix3::Identity(), {0.01, 0.02, 0.03}};
  tracker.offer(offered);
  const TrackedPose seen = tracker.sample(0.001);
  EXPECT_TRUE(seen.valid);
  EXPECT_EQ(seen.X_WFt.translation, offered.translation);
  tracker.close();
  tracker.offer(offered);
  EXPECT_FALSE(tracker.take_message().has_value());
}

}  // namespace
}  // namespace softfinger
