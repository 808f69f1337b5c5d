#include "softfinger/rendering.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace softfinger {
namespace {

const std::filesystem::path kScene =
    std::filesystem::path(SOFTFINGER_SOURCE_DIR) / "scenes" / "sphere.toml";

Pose at_height(double z) {
  Pose pose;
  pose.translation = {-3e-3, 0.0, z};
  return pose;
}

/// Down to 2.5 mm into the ball's contact and up again, 1 s.
RenderingSnapshot press(Rendering& rendering, double call_period) {
  RenderingSnapshot deepest;
  const int calls = static_cast<int>(1.0 / call_period + 0.5);
  for (int i = 0; i <= calls; ++i) {
    const double time = i * call_period;
    rendering.step(at_height(29e-3 - 4e-3 * std::min(time, 1.0 - time) * 2.0), 5.0 + time);
    const RenderingSnapshot now = rendering.snapshot();
    if (now.normal_force >= deepest.normal_force) deepest = now;
  }
  return deepest;
}

TEST(Rendering, FingerTouchesAndDeviceAnswers) {
  Rendering rendering(kScene);
  EXPECT_EQ(rendering.simulation_rate(), 1000.0);
  EXPECT_EQ(rendering.device_rate(), 30.0);
  EXPECT_THAT(rendering.configuration_names(),
              testing::ElementsAre("pitch_deg", "roll_deg", "travel_mm"));
  const RenderingSnapshot deepest = press(rendering, 1e-3);
  EXPECT_GT(deepest.normal_force, 0.05);
  EXPECT_GT(deepest.contact_area, 1e-6);
  EXPECT_GT(deepest.mean_normal_F.z(), 0.9);
  EXPECT_EQ(deepest.in_contact.size(), deepest.sample_positions_F.size());
  EXPECT_GT(deepest.X_WF.translation.z(), deepest.X_WFt.translation.z()) << "it stays behind";

  const RenderingCommand& command = rendering.step(at_height(40e-3), 6.001);
  EXPECT_EQ(command.tick, 30);
  EXPECT_EQ(command.configuration.size(), 3);
  EXPECT_EQ(command.joints.size(), 3);
  ASSERT_EQ(command.pulse_widths.size(), 3);
  EXPECT_THAT(command.pulse_widths,
              testing::Each(testing::AllOf(testing::Gt(0.5e-3), testing::Lt(2.5e-3))));
}

TEST(Rendering, SameCallsGiveTheSameBits) {
  Rendering a(kScene), b(kScene);
  const RenderingSnapshot in_a = press(a, 1e-3);
  const RenderingSnapshot in_b = press(b, 1e-3);
  EXPECT_EQ(in_a.X_WF.translation, in_b.X_WF.translation);
  EXPECT_EQ(in_a.normal_force, in_b.normal_force);
  EXPECT_EQ(in_a.sample_positions_F, in_b.sample_positions_F);
}

TEST(Rendering, SlowCallersGetEveryStep) {
  Rendering every_step(kScene), every_frame(kScene);
  const double fine = press(every_step, 1e-3).normal_force;
  const double coarse = press(every_frame, 1.0 / 50.0).normal_force;
  EXPECT_NEAR(coarse, fine, 0.02 * fine);
}

TEST(Rendering, LostTrackingHoldsThenRetracts) {
  Rendering rendering(kScene);
  double time = 0.0;
  for (; time < 1.0; time += 1e-3) rendering.step(at_height(40e-3), time);
  EXPECT_EQ(rendering.step(at_height(40e-3), time).state, "ready");
  Pose nowhere = at_height(40e-3);
  nowhere.translation.x() = std::numeric_limits<double>::quiet_NaN();
  for (const double end = time + 0.15; time < end; time += 1e-3) rendering.step(nowhere, time);
  EXPECT_EQ(rendering.lost(time).state, "holding");
  for (const double end = time + 0.2; time < end; time += 1e-3) rendering.lost(time);
  EXPECT_EQ(rendering.lost(time).state, "retracting");
  EXPECT_TRUE(rendering.snapshot().X_WF.translation.allFinite());
}

TEST(Rendering, OddTimesDoNoHarm) {
  Rendering rendering(kScene);
  rendering.step(at_height(40e-3), 1.7e9);  // a clock of the day
  rendering.step(at_height(40e-3), 1.7e9 + 0.01);
  EXPECT_NEAR(rendering.snapshot().time, 1.7e9 + 0.01, 1e-3);
  rendering.step(at_height(40e-3), 1.0);  // backwards
  rendering.step(at_height(40e-3), std::numeric_limits<double>::quiet_NaN());
  rendering.step(at_height(40e-3), 1.8e9);  // a gap of years is skipped
  EXPECT_NEAR(rendering.snapshot().time, 1.8e9, 1e-3);
}

TEST(Rendering, SaysWhatIsWrong) {
  EXPECT_THROW(Rendering("/no/such/scene.toml"), std::runtime_error);
  RenderingOptions options;
  options.finger = "thumb";
  try {
    Rendering rendering(kScene, options);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("thumb"));
    EXPECT_THAT(error.what(), testing::HasSubstr("index"));
  }
}

}  // namespace
}  // namespace softfinger
