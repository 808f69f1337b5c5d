// A tracker that seems to jump by a metre, in simulated time: finger and device move no faster than
// they may, and are where they should be after it.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <optional>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/loop/finger_loop.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/live_session.hpp"

namespace softfinger {
namespace {

/// What a headless run on the ball makes of a finger that presses there, but for where `jump` (mm,
/// at a row's time and number) puts it.
class TrackedJump : public testing::Test {
 protected:
  using Jump = std::function<double(double, int)>;

  void run(double duration, const Jump& jump) {
    {
      std::ofstream csv(directory_ / "poses.csv");
      csv << "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
      for (int row = 0; row <= static_cast<int>(duration * 100); ++row) {
        const double time = row / 100.0;
        const double depth = std::min(time / 0.5, 1.0) * 14.8;
        csv << time << ',' << -2.5 + jump(time, row) << ",0," << 40.5 - depth
            << ",0.998629534754574,0,0.052335956242944,0\n";
      }
    }
    RunOptions options;
    options.scene = scenes_.scene("sphere");
    options.trackers = {"csv:" + (directory_ / "poses.csv").string()};
    options.as_fast_as_possible = true;
    options.recording = directory_ / "run.db";
    const std::atomic<bool> stop{false};
    (void)run_headless(options, stop);
    limits_ = load_setup(options)->devices.at(0)->joint_limits();
    RecordingReader reader(directory_ / "run.db");
    StepRecord step;
    while (reader.next(step)) steps_.push_back(step);
    TickRecord tick;
    while (reader.next(tick)) ticks_.push_back(tick);
    std::filesystem::remove(directory_ / "run.db");
  }

  void expect_within_limits() const {
    ASSERT_GT(steps_.size(), 1000u);
    std::optional<Vector3> last;
    for (const StepRecord& step : steps_) {
      ASSERT_TRUE(step.X_WF.translation.allFinite());
      ASSERT_TRUE(std::isfinite(step.normal_force));
      // The bone may overshoot a little.
      if (last) {
        EXPECT_LT((step.X_WF.translation - *last).norm(), 1.5e-3 * kMaxTrackedSpeed);
      }
      last = step.X_WF.translation;
    }
    const TickRecord* before = nullptr;
    for (const TickRecord& tick : ticks_) {
      const JointAngles& joints = tick.command.joints;
      EXPECT_GE((joints - limits_.min).minCoeff(), -1e-9);
      EXPECT_GE((limits_.max - joints).minCoeff(), -1e-9);
      if (before != nullptr) {
        const double reach = limits_.max_rate * (tick.time - before->time) + 1e-6;
        EXPECT_LE((joints - before->command.joints).cwiseAbs().maxCoeff(), reach) << tick.time;
      }
      before = &tick;
      EXPECT_NE(tick.command.state, DeviceState::kRetracting) << "a jump is no lost tracking";
    }
  }
  double farthest_tracked() const {
    double farthest = 0.0;
    for (const StepRecord& step : steps_) {
      farthest = std::max(farthest, std::abs(step.tracked.X_WFt.translation.x()));
    }
    return farthest;
  }
  void expect_pressing_at_the_end() const {
    EXPECT_EQ(ticks_.back().command.state, DeviceState::kRendering);
    EXPECT_GT(steps_.back().contact_area, 1.0 * mm2);
    const StoredPose& tracked = steps_.back().tracked.X_WFt;
    EXPECT_LT((steps_.back().X_WF.translation - tracked.translation).norm(), 3.0 * mm);
  }

  ScenesWithoutForceLimit scenes_;
  TemporaryDirectory directory_;
  JointLimits limits_;
  std::vector<StepRecord> steps_;
  std::vector<TickRecord> ticks_;
};

TEST_F(TrackedJump, AMetreAwayAndBack) {
  run(2.4, [](double time, int) { return time > 0.8 && time < 1.4 ? 1000.0 : 0.0; });
  EXPECT_GT(farthest_tracked(), 0.99);
  expect_within_limits();
  expect_pressing_at_the_end();
  bool released = false;
  for (const TickRecord& tick : ticks_) {
    released = released || (tick.time > 0.8 && tick.command.state == DeviceState::kReady);
  }
  EXPECT_TRUE(released) << "it followed, or this test shows nothing";
}

TEST_F(TrackedJump, AGlitchOfOneSample) {
  run(1.5, [](double, int row) { return row == 90 ? 1000.0 : 0.0; });
  EXPECT_GT(farthest_tracked(), 0.9);
  expect_within_limits();
  expect_pressing_at_the_end();
  for (const StepRecord& step : steps_) {
    if (step.time < 0.6) continue;
    EXPECT_LT(std::abs(step.X_WF.translation.x() - steps_.back().X_WF.translation.x()), 25.0 * mm)
        << "20 ms at 1 m/s there, and overshoot";
  }
}

TEST_F(TrackedJump, EverySample) {
  run(1.6, [](double time, int row) {
    return time > 0.8 && time < 1.0 ? (row % 2 == 0 ? 500.0 : -500.0) : 0.0;
  });
  EXPECT_GT(farthest_tracked(), 0.49);
  expect_within_limits();
  expect_pressing_at_the_end();
}

}  // namespace
}  // namespace softfinger
