// Objects that a person takes at the page: held, thrown, recorded and replayed to the bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "../support/temporary_directory.hpp"
#include "recorded_run.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

/// A ball on a table beside a post, and nobody's finger.
class HeldObjectRun : public testing::Test {
 protected:
  HeldObjectRun() {
    std::ofstream(options_.scene = directory_ / "scene.toml")
        << "[[object]]\nname = \"ball\"\nshape = \"sphere\"\nradius_mm = 15.0\n"
           "motion = \"dynamic\"\nmass_g = 40.0\nposition_mm = [0, 0, 15]\n"
           "[[object]]\nname = \"table\"\nshape = \"plane\"\n"
           "[[object]]\nname = \"post\"\nshape = \"sphere\"\nradius_mm = 5.0\n"
           "position_mm = [100, 0, 5]\n";
    options_.recording = directory_ / "run.db";
    options_.duration = 3600.0;
  }
  /// Asks again and again until that holds of a snapshot.
  template <typename Condition>
  static bool until(LiveSession& session, const LiveRequest& request, const Condition& condition) {
    for (int k = 0; k < 6000; ++k) {
      session.request(request);
      session.refresh();
      if (session.latest().X_WO.size() == 3 && condition(session.latest())) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  static LiveRequest held(const char* object, const Vector3& at) {
    LiveRequest request;
    request.kind = LiveRequest::Kind::kHold;
    request.object = object;
    request.X_W.translation = at;
    return request;
  }
  static LiveRequest let_go(const char* object) {
    LiveRequest request;
    request.kind = LiveRequest::Kind::kLetGo;
    request.object = object;
    return request;
  }

  TemporaryDirectory directory_;
  RunOptions options_;
};

TEST_F(HeldObjectRun, IsLiftedAndFallsAndReplaysToTheBit) {
  LiveSession session(options_, false);
  std::atomic<bool> stop{false};
  std::thread running([&] { (void)session.run(stop); });
  const auto height = [](const Snapshot& s) { return s.X_WO[0].translation.z(); };
  EXPECT_TRUE(until(session, held("ball", {0.02, 0.0, 0.08}),
                    [&](const Snapshot& s) { return height(s) > 0.07; }));
  EXPECT_TRUE(until(session, let_go("ball"), [&](const Snapshot& s) { return height(s) < 0.016; }));
  // Neither what a script moves nor what is not there is taken.
  EXPECT_TRUE(
      until(session, held("post", {0.0, 0.0, 0.05}),
            [first = session.latest().step](const Snapshot& s) { return s.step > first + 300; }));
  session.request(held("cup", {0.0, 0.0, 0.05}));
  EXPECT_EQ(session.latest().X_WO[2].translation, Vector3(0.1, 0.0, 5e-3));
  stop = true;
  running.join();
  RecordingReader reader(*options_.recording);
  FollowRecord row;
  bool was_held = false, was_let_go = false;
  while (reader.next(row)) {
    EXPECT_EQ(row.object, 0);
    was_held = was_held || row.valid;
    was_let_go = was_let_go || (was_held && !row.valid);
  }
  EXPECT_TRUE(was_held && was_let_go);
  const ReplayResult again = replay({.recording = *options_.recording, .scene = {}});
  EXPECT_TRUE(again.agree) << *again.first_difference << " " << again.difference;
  EXPECT_GT(again.steps, 300);
}

TEST_F(HeldObjectRun, IsLetGoWhenNobodySaysAnythingMore) {
  options_.recording.reset();
  LiveSession session(options_, false);
  std::atomic<bool> stop{false};
  std::thread running([&] { (void)session.run(stop); });
  const auto height = [](const Snapshot& s) { return s.X_WO[0].translation.z(); };
  EXPECT_TRUE(until(session, held("ball", {0.0, 0.0, 0.08}),
                    [&](const Snapshot& s) { return height(s) > 0.07; }));
  EXPECT_TRUE(until(session, let_go("table"),  // of something else
                    [&](const Snapshot& s) { return height(s) < 0.016; }));
  stop = true;
  running.join();
}

}  // namespace
}  // namespace softfinger
