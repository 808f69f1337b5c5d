#include "softfinger/tracking/csv_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/tracking/make_tracker.hpp"

namespace softfinger {
namespace {

const std::string kHeader = "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";

std::filesystem::path write(const std::string& text) {
  // Tests may run side by side.
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const auto file = std::filesystem::path(testing::TempDir()) / (test + "_poses.csv");
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::string error_of(const std::string& text) {
  try {
    (void)read_pose_csv(write(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CsvTracker, InterpolatesPositionAndRotation) {
  // A quarter turn about z; the second quaternion is the negative of the same rotation.
  const auto file = write(kHeader +
                          "0,0,0,40,1,0,0,0\r\n"
                          " 0.1, 10,-4,40,-0.70710678,0,0,-0.70710678\n"
                          "0.2,10,-4,40,-0.70710678,0,0,-0.70710678\n\n");
  CsvTracker tracker(read_pose_csv(file));
  const TrackedPose quarter = tracker.sample(0.025);
  EXPECT_TRUE(quarter.valid);
  EXPECT_DOUBLE_EQ(quarter.time, 0.025);
  EXPECT_LT((quarter.X_WFt.translation - Vector3(0.0025, -0.001, 0.04)).norm(), 1e-15);
  const Vector3 turn = log_rotation(quarter.X_WFt.rotation);
  EXPECT_LT((turn - Vector3(0, 0, std::acos(-1.0) / 8)).norm(), 1e-8);
  EXPECT_DOUBLE_EQ(*tracker.end_time(), 0.2);
  EXPECT_LT((tracker.sample(0.1).X_WFt.translation - Vector3(0.01, -0.004, 0.04)).norm(), 1e-15);
}

TEST(CsvTracker, LosesTrackingInLongGaps) {
  std::vector<PoseSample> rows;
  for (const double t : {0.5, 0.7, 1.2, 1.3}) {
    rows.push_back({.time = t, .p_WFt = Vector3(t, 0, 0), .rotation_WFt = {1, 0, 0, 0}});
  }
  CsvTracker tracker(rows);
  EXPECT_FALSE(tracker.sample(0.0).valid);  // nothing known yet
  EXPECT_TRUE(tracker.sample(0.5).valid);
  EXPECT_TRUE(tracker.sample(0.6).valid);  // 200 ms is not over 200 ms
  EXPECT_DOUBLE_EQ(tracker.sample(0.6).X_WFt.translation.x(), 0.6);
  EXPECT_TRUE(tracker.sample(0.85).valid);
  EXPECT_DOUBLE_EQ(tracker.sample(0.85).X_WFt.translation.x(), 0.7);
  EXPECT_DOUBLE_EQ(tracker.sample(0.85).time, 0.7);
  EXPECT_FALSE(tracker.sample(0.91).valid);
  EXPECT_DOUBLE_EQ(tracker.sample(1.19).X_WFt.translation.x(), 0.7);
  EXPECT_TRUE(tracker.sample(1.2).valid);
  EXPECT_TRUE(tracker.sample(1.4).valid);
  EXPECT_FALSE(tracker.sample(1.6).valid);
}

TEST(CsvTracker, NamesFileLineAndColumnOfBadInput) {
  using testing::HasSubstr;
  EXPECT_THAT(error_of("time,x,y,z\n"), HasSubstr("poses.csv:1: expected the header time_s,"));
  EXPECT_THAT(error_of(""), HasSubstr("no poses"));
  EXPECT_THAT(error_of(kHeader), HasSubstr("no poses"));
  EXPECT_THAT(error_of(kHeader + "0,0,0,40,1,0,0\n"), HasSubstr("poses.csv:2: expected 8 numbers"));
  EXPECT_THAT(error_of(kHeader + "0,0,0,40,1,0,0,0,0\n"), HasSubstr(":2: expected 8 numbers"));
  EXPECT_THAT(error_of(kHeader + "0,0,0,40,1,0,0,0\n1,0,abc,40,1,0,0,0\n"),
              HasSubstr(":3: y_mm: expected a finite number, found 'abc'"));
  EXPECT_THAT(error_of(kHeader + "0,nan,0,40,1,0,0,0\n"), HasSubstr(":2: x_mm: expected a finite"));
  EXPECT_THAT(error_of(kHeader + "0,inf,0,40,1,0,0,0\n"), HasSubstr(":2: x_mm: expected a finite"));
  EXPECT_THAT(error_of(kHeader + "0,1e9,0,40,1,0,0,0\n"), HasSubstr(":2: x_mm: must be between"));
  EXPECT_THAT(error_of(kHeader + "0,1 2,0,40,1,0,0,0\n"), HasSubstr(":2: x_mm: expected a finite"));
  EXPECT_THAT(error_of(kHeader + "0,,0,40,1,0,0,0\n"), HasSubstr(":2: x_mm: expected a finite"));
  EXPECT_THAT(error_of(kHeader + "0,0,0,40,1.02,0,0,0\n"), HasSubstr(":2: qw: the quaternion"));
  EXPECT_THAT(error_of(kHeader + "0,0,0,40,0,0,0,0\n"), HasSubstr(":2: qw: the quaternion"));
  EXPECT_THAT(error_of(kHeader + "1,0,0,40,1,0,0,0\n1,0,0,40,1,0,0,0\n"),
              HasSubstr(":3: time_s: times must increase"));
  EXPECT_THAT(error_of(kHeader + "0,0,0,40,1.005,0,0,0\n"), "no error");
  EXPECT_THROW((void)read_pose_csv("/nonexistent/poses.csv"), InputError);
  EXPECT_THROW((void)read_pose_csv(testing::TempDir()), InputError);
}

TEST(MakeTracker, BuildsWhatTheSpecNames) {
  const auto file = write(kHeader + "0,0,0,40,1,0,0,0\n0.5,0,0,40,1,0,0,0\n");
  const auto csv = make_tracker("csv:" + file.filename().string(), file.parent_path(), {});
  EXPECT_DOUBLE_EQ(*csv->end_time(), 0.5);
  const auto absolute = make_tracker("csv:" + file.string(), "/elsewhere", {});
  EXPECT_DOUBLE_EQ(*absolute->end_time(), 0.5);
  const std::vector<Waypoint> waypoints{{0.0, {}}, {2.0, {Matrix3::Identity(), {0, 0, 1}}}};
  const auto script = make_tracker("script", "", waypoints);
  EXPECT_DOUBLE_EQ(*script->end_time(), 2.0);
  EXPECT_TRUE(script->sample(1.0).valid);
  EXPECT_DOUBLE_EQ(script->sample(1.0).X_WFt.translation.z(), 0.5);
}

TEST(MakeTracker, RefusesWhatItDoesNotKnow) {
  for (const char* spec : {"", "scrip", "script:x", "csv", "csv:", "natnet:host", "webcam"}) {
    EXPECT_THROW((void)make_tracker(spec, "", {{0.0, {}}}), InputError) << spec;
  }
  EXPECT_THROW((void)make_tracker("script", "", {}), InputError);
  try {
    (void)make_tracker("scrpt", "", {});
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'script'"));
    EXPECT_THAT(error.what(), testing::HasSubstr("csv:FILE"));
  }
}

}  // namespace
}  // namespace softfinger
