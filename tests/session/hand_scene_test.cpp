#include <gtest/gtest.h>

#include <atomic>

#include "../support/folders.hpp"
#include "softfinger/session/live_session.hpp"

namespace softfinger {
namespace {

TEST(HandScene, EveryFingerTouchesTheBallAndItsDeviceFollows) {
  RunOptions options;
  options.scene = source_folder() + "/scenes/hand.toml";
  options.duration = 1.6;
  options.as_fast_as_possible = true;
  options.threads = 2;
  const std::atomic<bool> stop{false};
  const RunSummary summary = run_headless(options, stop);
  ASSERT_EQ(summary.fingers.size(), 5u);
  for (const auto& [name, finger] : summary.fingers) {
    EXPECT_GT(finger.max_normal_force, 0.3) << name;
    EXPECT_LT(finger.max_normal_force, 3.0) << name;
    EXPECT_GT(finger.max_contact_area, 20e-6) << name;
    EXPECT_EQ(finger.unconverged_steps, 0u) << name;
    EXPECT_GT(finger.commands_sent, 40u) << name;
  }
}

TEST(HandScene, AHeadsetMovesAllOfIt) {
  RunOptions options;
  options.scene = source_folder() + "/scenes/hand.toml";
  options.trackers = {"webxr:left"};
  const auto setup = load_setup(options);
  for (const SceneFinger& finger : setup->scene.fingers) {
    EXPECT_EQ(finger.tracker, "webxr:left-" + finger.name);
  }
}

}  // namespace
}  // namespace softfinger
