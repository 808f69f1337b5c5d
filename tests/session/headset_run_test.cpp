#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/run_setup.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

/// Two fingers with nothing to touch and no device.
class HeadsetRun : public testing::Test {
 protected:
  HeadsetRun() {
    options_.scene = directory_ / "scene.toml";
    std::ofstream scene(options_.scene);
    for (const char* name : {"thumb", "other"}) {
      scene << "[[finger]]\nname = \"" << name << "\"\nmodel = \""
            << (fs::path(source_folder()) / "fingers/index.toml").string()
            << "\"\n[[finger.waypoint]]\ntime_s = 0.0\nposition_mm = [0.0, 0.0, 100.0]\n"
               "rotation_vector_deg = [0.0, 0.0, 0.0]\n";
    }
    scene << "[[object]]\nname = \"ground\"\nshape = \"plane\"\n";
  }
  std::vector<std::string> trackers(std::vector<std::string> flags) {
    options_.trackers = std::move(flags);
    const auto setup = load_setup(options_);
    return {setup->scene.fingers[0].tracker, setup->scene.fingers[1].tracker};
  }

  TemporaryDirectory directory_;
  RunOptions options_;
};

TEST_F(HeadsetRun, AWholeHandMovesEachFingerByItsName) {
  using Trackers = std::vector<std::string>;
  EXPECT_EQ(trackers({"webxr"}), (Trackers{"webxr:right-thumb", "webxr:right-index"}));
  EXPECT_EQ(trackers({"webxr:left"}), (Trackers{"webxr:left-thumb", "webxr:left-index"}));
  EXPECT_EQ(trackers({"webxr", "other=webxr:ring"}), (Trackers{"webxr:right-thumb", "webxr:ring"}));
  EXPECT_EQ(trackers({"other=webxr"}), (Trackers{"script", "webxr:right-index"}));
  EXPECT_THROW((void)trackers({"webxr:ring"}), InputError) << "of which finger?";
}

TEST_F(HeadsetRun, NobodyWearsAHeadsetInAHeadlessRun) {
  options_.trackers = {"webxr"};
  options_.duration = 0.01;
  const std::atomic<bool> stop{false};
  EXPECT_THROW((void)run_headless(options_, stop), InputError);
}

TEST_F(HeadsetRun, AHandMovesTheFingersThatFollowIt) {
  options_.trackers = {"thumb=webxr"};
  LiveSession session(options_, false);
  std::atomic<bool> stop{false};
  std::thread running([&] { (void)session.run(stop); });
  XrHand hand{.tracked = true};
  for (XrJoint& joint : hand.joints) joint.position = {0.0F, 0.05F, -0.02F};
  double thumb = 1.0;
  for (int frame = 1; frame < 2000 && thumb > 1e-3; ++frame) {
    hand.time = 0.01 * frame;
    session.offer_hand(hand);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (!session.refresh()) continue;
    thumb = (session.latest().fingers[0].X_WFt.translation - Vector3(0.02, 0.0, 0.05)).norm();
    EXPECT_EQ(session.latest().fingers[1].X_WFt.translation.z(), 0.1);
  }
  EXPECT_LT(thumb, 1e-3);
  stop.store(true);
  running.join();
}

}  // namespace
}  // namespace softfinger
