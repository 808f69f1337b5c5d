// A force sensor under known weights.

#include "softfinger/sensing/force_calibration.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {
namespace {

TEST(ForceCalibration, FindsScaleAndZero) {
  std::vector<LoadedReading> readings;
  for (const double force : {0.0, 0.2, 0.5, 1.0})
    readings.push_back({force, 8412.0 - 2000.0 * force});
  const ForceCalibration found = calibrate_force(readings);
  EXPECT_NEAR(found.scale, -1.0 / 2000.0, 1e-12);
  EXPECT_NEAR(found.zero, 8412.0, 1e-9);
  EXPECT_NEAR(found.deviation, 0.0, 1e-12);
}

TEST(ForceCalibration, WhatIsNoCalibrationIsRefused) {
  const auto refused = [](const std::vector<LoadedReading>& readings, const std::string& word) {
    try {
      (void)calibrate_force(readings);
      ADD_FAILURE() << "calibrated";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused({}, "two different loads");
  refused({{0.5, 1.0}, {0.5, 1.1}}, "two different loads");
  refused({{0.0, 7.0}, {1.0, 7.0}}, "dead or stuck");
  refused({{0.0, 0.0}, {0.5, 9.0}, {1.0, 10.0}}, "no line");
}

TEST(ForceCalibration, ItsTextIsRead) {
  ForceSensorSettings settings;
  settings.kind = ForceSensorKind::kSerial;
  settings.port = "/dev/ttyUSB0";
  settings.scale = -4.9e-6;
  settings.zero = 8412345.0;
  const ConfigFile file("device.toml", force_sensor_text(settings));
  const ForceSensorSettings read = read_force_sensor(file.root().table("force_sensor"));
  EXPECT_EQ(read.port, settings.port);
  EXPECT_DOUBLE_EQ(read.scale, settings.scale);
  EXPECT_DOUBLE_EQ(read.zero, settings.zero);
  EXPECT_DOUBLE_EQ(read.stale, settings.stale);
}

}  // namespace
}  // namespace softfinger
