#include "softfinger/device/device_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "../support/folders.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "thimble.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The shipped file with `from` replaced by `to`, loaded.
std::shared_ptr<const Device> loaded(const std::string& from, const std::string& to) {
  std::ifstream shipped(source_folder() + "/devices/thimble-3rrs.toml");
  std::stringstream text;
  text << shipped.rdbuf();
  std::string content = text.str();
  const std::size_t at = content.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  content.replace(at, from.size(), to);
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) /
                                     ("device_under_test_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << content;
  return load_device(file);
}

/// What it says when it is refused.
std::string refusal(const std::string& from, const std::string& to) {
  try {
    static_cast<void>(loaded(from, to));
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THAT(message, HasSubstr("device_under_test_"));
    return message;
  }
  return {};
}

TEST(DeviceFile, ReadsEveryKey) {
  const DeviceSettings& settings = thimble().settings();
  EXPECT_EQ(settings.kind, "platform_3rrs");
  ASSERT_EQ(settings.axes.size(), 3U);
  EXPECT_EQ(settings.axes[0].name, "pitch_deg");
  EXPECT_EQ(settings.axes[1].name, "roll_deg");
  EXPECT_EQ(settings.axes[2].name, "travel_mm");
  EXPECT_DOUBLE_EQ(settings.joint_limits.max_rate, 400.0 * deg);
  EXPECT_DOUBLE_EQ(settings.matching.approach, 3.0 * mm);
  EXPECT_DOUBLE_EQ(settings.max_force, 4.7);
  ASSERT_TRUE(settings.transport.has_value());
  EXPECT_EQ(settings.transport->servos.size(), 3U);
  EXPECT_NEAR(settings.transport->servos[0].per_radian, 10.0 * us / deg, 1e-15);
  EXPECT_NEAR(settings.transport->servos[2].zero, 1275.0 * us, 1e-15);
  EXPECT_THAT(settings.as_read, HasSubstr("\"disk_edge_radius_mm\""));
}

TEST(DeviceFile, AcceptsWhatIsUnchanged) {
  EXPECT_EQ(refusal("kind = \"platform_3rrs\"", "kind = \"platform_3rrs\""), "");
}

TEST(DeviceFile, RefusesWithFileLineAndKey) {
  EXPECT_THAT(refusal("crank_mm = 12.0", "crank_mm = -12.0"), HasSubstr("crank_mm"));
  EXPECT_THAT(refusal("crank_mm = 12.0", "crank_mm = nan"), HasSubstr("crank_mm"));
  EXPECT_THAT(refusal("crank_mm = 12.0", "crank_m = 12.0"), HasSubstr("crank_m"));
  EXPECT_THAT(refusal("crank_mm = 12.0", "crank_mm = \"long\""), HasSubstr("crank_mm"));
  EXPECT_THAT(refusal("kind = \"platform_3rrs\"", "kind = \"platform_3rps\""), HasSubstr("kind"));
  EXPECT_THAT(refusal("joint_deg = [-30.0, 75.0]", "joint_deg = [75.0, -30.0]"),
              HasSubstr("joint_deg"));
  EXPECT_THAT(refusal("on = \"distal\"", "on = \"middle\""), HasSubstr("distal"));
  EXPECT_THAT(refusal("objective = \"surface_and_force\"", "objective = \"fun\""),
              HasSubstr("objective"));
  EXPECT_THAT(refusal("objective", "turn_on_skin_deg_per_s = 0.0\nobjective"),
              HasSubstr("turn_on_skin_deg_per_s"));
}

TEST(DeviceFile, KnowsEveryObjectiveAndWhatOneWasCalled) {
  const auto named = [](const std::string& name) {
    return loaded("objective = \"surface_and_force\"", "objective = \"" + name + "\"")
        ->settings()
        .matching.objective;
  };
  for (const std::string_view name : kDeviceObjectives) EXPECT_EQ(named(std::string(name)), name);
  EXPECT_EQ(named("contact_plane"), "plane");
}

TEST(DeviceFile, SaysHowFastItGivesBackWhatMeansNothing) {
  const EasingRates shipped = thimble().settings().matching.easing;
  EXPECT_DOUBLE_EQ(shipped.turn_on_skin, 36.0 * deg);
  EXPECT_DOUBLE_EQ(shipped.move_off_skin, 30.0 * mm);
  const EasingRates given = loaded("objective",
                                   "turn_on_skin_deg_per_s = 1\nturn_off_skin_deg_per_s = 2\n"
                                   "move_off_skin_mm_per_s = 3\nturn_by_force_deg_per_s = 4\n"
                                   "move_by_force_mm_per_s = 5\nobjective")
                                ->settings()
                                .matching.easing;
  EXPECT_DOUBLE_EQ(given.turn_on_skin, 1.0 * deg);
  EXPECT_DOUBLE_EQ(given.turn_off_skin, 2.0 * deg);
  EXPECT_DOUBLE_EQ(given.move_off_skin, 3.0 * mm);
  EXPECT_DOUBLE_EQ(given.turn_by_force, 4.0 * deg);
  EXPECT_DOUBLE_EQ(given.move_by_force, 5.0 * mm);
}

TEST(DeviceFile, RefusesAHomeOutOfTheWorkspace) {
  EXPECT_THAT(refusal("joint_deg = [-30.0, 75.0]", "joint_deg = [40.0, 75.0]"),
              AllOf(HasSubstr("home"), HasSubstr("joint 1")));
  EXPECT_THAT(refusal("neutral_height_mm = 28.0", "neutral_height_mm = 60.0"),
              AllOf(HasSubstr("home"), HasSubstr("do not reach")));
  EXPECT_THAT(refusal("pitch_deg = 0.0", "pitch_deg = 31.0"),
              AllOf(HasSubstr("home"), HasSubstr("max_tilt_deg")));
}

TEST(DeviceFile, RefusesARetractedPoseOutOfTheWorkspace) {
  EXPECT_THAT(refusal("travel_mm = -4.0", "travel_mm = -14.0"), HasSubstr("retract"));
}

TEST(DeviceFile, RefusesServosThatDoNotFit) {
  EXPECT_THAT(refusal("max_us = 2050.0", "max_us = 1900.0"),
              AllOf(HasSubstr("us_per_deg"), HasSubstr("joint 1"), HasSubstr("75")));
  EXPECT_THAT(refusal("us_per_deg = 10.0", "us_per_deg = 0.0"), HasSubstr("us_per_deg"));
  EXPECT_THAT(refusal("channel = 1", "channel = 0"), HasSubstr("channel"));
  EXPECT_THAT(refusal("[[transport.servo]]\nchannel = 2", "[[transport.motor]]\nchannel = 2"),
              HasSubstr("servo"));
}

TEST(DeviceFile, RefusesSupervisionThatNoDeviceCanKeep) {
  const std::string rate = "joint_rate_deg_per_s = 400.0";
  EXPECT_EQ(refusal(rate, rate + "\nfollowing_error_deg = 5.0\nmax_press_s = 10.0"), "");
  EXPECT_THAT(refusal(rate, rate + "\nfollowing_error_deg = 0.1"),
              AllOf(HasSubstr("limits.following_error_deg"), HasSubstr("at least 0.2")));
  EXPECT_THAT(refusal(rate, rate + "\nfollowing_error_mm = 5.0"), HasSubstr("following_error_mm"));
  EXPECT_THAT(refusal(rate, rate + "\nmax_press_s = 0.0"), HasSubstr("limits.max_press_s"));
  EXPECT_THAT(refusal("[transport]", "[transport]\nat_end = \"limp\""),
              AllOf(HasSubstr("transport.at_end"), HasSubstr("torque_off")));
}

TEST(DeviceFile, SupervisesWhatItsFileDoesNotSay) {
  const DeviceSettings& settings = thimble().settings();
  EXPECT_NEAR(settings.following_error, 0.2 * 105.0 * deg, 1e-9);
  EXPECT_EQ(settings.press_time, 120.0);
}

// Levers that pass a singularity below their tilt limit are allowed; the workspace ends there.
TEST(DeviceFile, WorkspaceEndsAtASingularity) {
  DeviceSettings settings;
  settings.kind = "platform_3rrs";
  settings.home = Configuration::Zero(3);
  settings.retracted = settings.home;
  settings.joint_limits = {JointAngles::Constant(3, -170.0 * deg),
                           JointAngles::Constant(3, 170.0 * deg), 1.0};
  settings.axes = Platform3rrs::axes_for(8.0 * mm);
  const Platform3rrs device(settings, {16.0 * mm, 12.0 * mm, 14.0 * mm, 18.0 * mm, 22.0 * mm,
                                       8.0 * mm, 0.5 * mm, 40.0 * deg});
  bool ended = false;
  for (int direction = 0; direction < 360; direction += 10) {
    bool inside = true;
    for (double tilt = 0.0; tilt < 40.0; tilt += 0.25) {
      const Configuration q =
          configuration(tilt * std::cos(direction * deg), tilt * std::sin(direction * deg), 0.0);
      if (inside && !device.reachable(q)) {
        inside = false;
        ended = true;
      }
      if (device.reachable(q)) {
        EXPECT_GT(device.singularity_ratio(q), 0.0);
      }
    }
  }
  EXPECT_TRUE(ended);
}

TEST(DeviceFile, MotorStaticsAreReadInTheirUnits) {
  const auto device = loaded("torque_N_mm = 78.0", "torque_N_mm = 50.0");
  ASSERT_TRUE(device->settings().statics.has_value());
  const MotorStatics& statics = *device->settings().statics;
  EXPECT_NEAR(statics.holding, 0.05, 1e-15);
  EXPECT_NEAR(statics.compliance, 0.02 * deg / 1e-3, 1e-12);
  EXPECT_NEAR(statics.backlash, 0.5 * deg, 1e-15);
}

TEST(DeviceFile, MotorStaticsThatAreNoneAreRefused) {
  const std::string torque = "torque_N_mm = 78.0";
  EXPECT_THAT(refusal(torque, "torque_N_mm = -1.0"), HasSubstr("statics.torque_N_mm"));
  EXPECT_THAT(refusal(torque, "force_N = 3.0"), HasSubstr("force_N"));
  EXPECT_THAT(refusal("torque_N_mm = 78.0\ncompliance_deg_per_N_mm = 0.02\nbacklash_deg = 0.5", ""),
              AllOf(HasSubstr("statics"), HasSubstr("says nothing; give torque_N_mm")));
}

}  // namespace
}  // namespace softfinger
