#include "softfinger/device/servo_calibration.hpp"

#include <gtest/gtest.h>

#include <limits>

#include <random>

#include "../support/lever_platform.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

// Who looks closely finds the map that is true, whatever the file said: reversed, shifted, scaled.
TEST(ServoCalibration, FindsTheTrueMap) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const ServoSettings file{
        .zero = 2048.0, .per_radian = 650.0, .min = 0.0, .max = 4095.0, .step = 1.0};
    ServoSettings truth = file;
    truth.zero += 500.0 * uniform(random);
    truth.per_radian *= (uniform(random) < 0.0 ? -1.0 : 1.0) * (1.0 + 0.4 * uniform(random));
    const double home = 0.4 * uniform(random);
    const double told = 10.0 * deg;
    const double first = ServoMap(file).setpoint(home);
    const double second = ServoMap(file).setpoint(home + told);
    const ServoSighting seen{.told = told,
                             .at = ServoMap(truth).joint(first),
                             .moved = ServoMap(truth).joint(second) - ServoMap(truth).joint(first)};
    const ServoSettings found = calibrated(file, first, seen);
    EXPECT_NEAR(found.per_radian, truth.per_radian, 1e-6);
    EXPECT_NEAR(found.zero, truth.zero, 1e-6);
    const JointRange range = joint_range(found);
    EXPECT_LT(range.min, range.max);
    EXPECT_NEAR(ServoMap(truth).setpoint(range.min) + ServoMap(truth).setpoint(range.max), 4095.0,
                1e-6);
  }
}

TEST(ServoCalibration, RefusesAJointThatDidNotMove) {
  const ServoSettings file{.zero = 2048.0, .per_radian = 650.0, .max = 4095.0, .step = 1.0};
  for (const double moved : {0.0, 1.0 * deg, 25.0 * deg, -30.0 * deg}) {
    EXPECT_THROW((void)calibrated(file, 2048.0, {.told = 10.0 * deg, .at = 0.0, .moved = moved}),
                 InputError);
  }
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(
      (void)calibrated(file, 2048.0, {.told = 10.0 * deg, .at = nowhere, .moved = 10.0 * deg}),
      InputError);
}

const std::atomic<bool> kGoOn{false};

TEST(ServoCalibration, MovesOneJointAndComesBack) {
  ServoCalibration calibration(lever_platform({.kind = "dynamixel"}), "emulator", kGoOn);
  ASSERT_EQ(calibration.servos(), 3);
  const double told = calibration.move_away(1);
  EXPECT_NEAR(std::abs(told), 10.0 * deg, 1e-9);
  calibration.move_back();
  // Seen as told, nothing changes.
  const ServoSettings same =
      calibration.calibrated_servo(1, {.told = told, .at = calibration.home(1), .moved = told});
  const ServoSettings file = lever_platform({.kind = "dynamixel"})->settings().transport->servos[1];
  EXPECT_NEAR(same.zero, file.zero, 1e-9);
  EXPECT_NEAR(same.per_radian, file.per_radian, 1e-9);
}

TEST(ServoCalibration, RefusesWhatHasNoJointServos) {
  EXPECT_THROW(ServoCalibration(lever_platform({.kind = "weart"}), "", kGoOn), InputError);
  EXPECT_THROW(ServoCalibration(lever_platform(), "/dev/no-such-port", kGoOn), InputError);
}

}  // namespace
}  // namespace softfinger
