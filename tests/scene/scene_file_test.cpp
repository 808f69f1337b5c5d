#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "../support/folders.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::filesystem::path write(const std::string& text) {
  // Tests may run side by side.
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const auto file = std::filesystem::path(testing::TempDir()) / (test + "_scene.toml");
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::string error_of(const std::string& text) {
  try {
    (void)load_scene(write(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

const std::string kFinger = R"([[finger]]
name = "index"
model = "../fingers/index.toml"
[[finger.waypoint]]
time_s = 0.0
position_mm = [0, 0, 40]
)";

std::string with_object(const std::string& object) { return kFinger + "[[object]]\n" + object; }

TEST(SceneFile, ReadsEveryKey) {
  const auto file = write(R"(description = "Two fingers"
[[finger]]
name = "index"
model = "../fingers/index.toml"
device = "../devices/thimble.toml"
tracker = "script"
[[finger.waypoint]]
time_s = 0.5
position_mm = [1.0, 2.0, 40.0]
rotation_vector_deg = [0.0, 90.0, 0.0]
[[finger.waypoint]]
time_s = 1.5
position_mm = [1.0, 2.0, 30.0]
[[finger]]
name = "thumb"
model = "/abs/thumb.toml"
tracker = "csv:poses.csv"
[[object]]
name = "floor"
shape = "plane"
friction_coefficient = 0.25
[[object]]
shape = "sphere"
radius_mm = 20
position_mm = [0, 0, -20]
[[object]]
shape = "sphere"
name = "sphere_2"
radius_mm = 5
[[object]]
shape = "box"
size_mm = [10, 20, 30]
edge_radius_mm = 2
rotation_vector_deg = [0, 0, 90]
[[object]]
shape = "box"
size_mm = [10, 1, 30]
[[object]]
shape = "cylinder"
radius_mm = 8
length_mm = 30
position_mm = [1, 2, 3]
[[object.waypoint]]
time_s = 0
[[object.waypoint]]
time_s = 1
position_mm = [5, 2, 3]
rotation_vector_deg = [0, 0, 45]
[rates]
simulation_Hz = 2000
)");
  const Scene scene = load_scene(file);
  EXPECT_EQ(scene.file, file);
  EXPECT_EQ(scene.description, "Two fingers");
  EXPECT_EQ(scene.simulation_rate, 2000.0);
  ASSERT_EQ(scene.fingers.size(), 2u);
  const SceneFinger& index = scene.fingers[0];
  EXPECT_EQ(index.name, "index");
  EXPECT_EQ(index.model, file.parent_path() / "../fingers/index.toml");
  EXPECT_EQ(index.device, file.parent_path() / "../devices/thimble.toml");
  EXPECT_EQ(index.tracker, "script");
  ASSERT_EQ(index.waypoints.size(), 2u);
  EXPECT_EQ(index.waypoints[0].time, 0.5);
  EXPECT_LT((index.waypoints[0].pose.translation - Vector3(0.001, 0.002, 0.04)).norm(), 1e-15);
  // A quarter turn about y takes x to -z: fingertip down.
  EXPECT_LT((index.waypoints[0].pose.rotation * Vector3::UnitX() + Vector3::UnitZ()).norm(), 1e-12);
  EXPECT_EQ(index.waypoints[1].pose.rotation, Matrix3::Identity());
  EXPECT_EQ(scene.fingers[1].model, "/abs/thumb.toml");
  EXPECT_EQ(scene.fingers[1].tracker, "csv:poses.csv");
  EXPECT_FALSE(scene.fingers[1].device.has_value());

  ASSERT_EQ(scene.objects.size(), 6u);
  EXPECT_EQ(scene.objects[0].name, "floor");
  EXPECT_TRUE(std::holds_alternative<HalfSpace>(scene.objects[0].shape));
  EXPECT_EQ(scene.objects[0].friction_coefficient, 0.25);
  EXPECT_EQ(scene.objects[1].name, "sphere");
  EXPECT_EQ(std::get<Ball>(scene.objects[1].shape).radius, 0.02);
  EXPECT_EQ(scene.objects[1].motion.sample(0).translation, Vector3(0, 0, -0.02));
  EXPECT_FALSE(scene.objects[1].friction_coefficient.has_value());
  EXPECT_EQ(scene.objects[2].name, "sphere_2");
  const auto& box = std::get<RoundedBox>(scene.objects[3].shape);
  EXPECT_LT((box.half_size - Vector3(0.005, 0.01, 0.015)).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(box.edge_radius, 0.002);
  EXPECT_DOUBLE_EQ(std::get<RoundedBox>(scene.objects[4].shape).edge_radius, 0.0005);
  EXPECT_EQ(scene.objects[4].name, "box_2");
  const auto& cylinder = std::get<RoundedCylinder>(scene.objects[5].shape);
  EXPECT_DOUBLE_EQ(cylinder.radius, 0.008);
  EXPECT_DOUBLE_EQ(cylinder.half_length, 0.015);
  EXPECT_DOUBLE_EQ(cylinder.edge_radius, 0.001);
  EXPECT_TRUE(scene.objects[5].motion.moves());
  EXPECT_LT((scene.objects[5].motion.sample(0).translation - Vector3(0.001, 0.002, 0.003)).norm(),
            1e-15);
  EXPECT_LT((scene.objects[5].motion.sample(1).translation - Vector3(0.005, 0.002, 0.003)).norm(),
            1e-15);
}

TEST(SceneFile, DefaultsAndWaypointsOfOtherTrackers) {
  const Scene scene = load_scene(write(kFinger));
  EXPECT_EQ(scene.simulation_rate, 1000.0);
  EXPECT_TRUE(scene.objects.empty());
  EXPECT_EQ(scene.fingers[0].tracker, "script");
  const std::string csv = "[[finger]]\nname = \"a\"\nmodel = \"m\"\ntracker = \"csv:x.csv\"\n";
  EXPECT_EQ(error_of(csv + "[[finger.waypoint]]\ntime_s = 0\nposition_mm = [0, 0, 0]\n"),
            "no error");
  EXPECT_THAT(error_of(csv + "[[finger.waypoint]]\ntime_s = 0\nposition_m = [0, 0, 0]\n"),
              HasSubstr("position_m"));
}

TEST(SceneFile, ScriptNeedsWaypointsUnlessTrackersComeFromElsewhere) {
  const std::string bare = "[[finger]]\nname = \"a\"\nmodel = \"m\"\n";
  EXPECT_THAT(error_of(bare), HasSubstr("waypoint"));
  EXPECT_EQ(load_scene(write(bare), true).fingers.size(), 1u);
  EXPECT_THAT(error_of(bare + "[[finger.waypont]]\ntime_s = 0\n"), HasSubstr("'waypoint'"));
}

TEST(SceneFile, NamesLineAndKeyOfFingerErrors) {
  EXPECT_THAT(error_of(""), HasSubstr("at least one [[finger]]"));
  EXPECT_THAT(error_of("[[fingr]]\nname = \"a\"\n"),
              AllOf(HasSubstr(":1:"), HasSubstr("'finger'")));
  EXPECT_THAT(error_of(kFinger + kFinger), AllOf(HasSubstr(":8:"), HasSubstr("named 'index'")));
  EXPECT_THAT(error_of("[[finger]]\nname = \"a=b\"\nmodel = \"m\"\n"),
              AllOf(HasSubstr(":2:"), HasSubstr("name")));
  EXPECT_THAT(error_of("[[finger]]\nname = \"a\"\nmodel = \"m\"\ntracker = \"webcam\"\n"),
              AllOf(HasSubstr(":4: finger[0].tracker"), HasSubstr("csv:FILE")));
  EXPECT_THAT(error_of(kFinger + "[[finger.waypoint]]\ntime_s = 0\nposition_mm = [0, 0, 0]\n"),
              AllOf(HasSubstr(":8: finger[0].waypoint[1].time_s"), HasSubstr("must increase")));
  EXPECT_THAT(error_of(kFinger + "[[finger.waypoint]]\ntime_s = 1\nposition_mm = [0, 0]\n"),
              AllOf(HasSubstr(":9: finger[0].waypoint[1].position_mm"), HasSubstr("3 numbers")));
  EXPECT_THAT(error_of(kFinger + "[[finger.waypoint]]\ntime_s = 1\nposition_mm = [0, 0, nan]\n"),
              HasSubstr("finite"));
  EXPECT_THAT(error_of(kFinger + "[[finger.waypoint]]\ntime_s = -1\nposition_mm = [0, 0, 0]\n"),
              HasSubstr("time_s"));
  EXPECT_THAT(error_of(kFinger + "[rates]\nsimulation_Hz = 50\n"),
              AllOf(HasSubstr(":8: rates.simulation_Hz"), HasSubstr("100")));
  EXPECT_THAT(error_of(kFinger + "[rates]\nsimulation_kHz = 1\n"), HasSubstr("'simulation_Hz'"));
}

TEST(SceneFile, NamesLineAndKeyOfObjectErrors) {
  EXPECT_THAT(
      error_of(with_object("shape = \"prism\"\n")),
      AllOf(HasSubstr(":8: object[0].shape"), HasSubstr("plane, sphere, box, cylinder, mesh")));
  EXPECT_THAT(error_of(with_object("shape = \"mesh\"\nfile = \"a.stl\"\n")),
              AllOf(HasSubstr("object[0].unit"), HasSubstr("one of mm, cm, m, inch")));
  EXPECT_THAT(error_of(with_object("radius_mm = 2\n")), HasSubstr("shape"));
  EXPECT_THAT(error_of(with_object("shape = \"sphere\"\nradius_mm = -2\n")),
              HasSubstr(":9: object[0].radius_mm"));
  EXPECT_THAT(error_of(with_object("shape = \"sphere\"\nradius_mm = nan\n")), HasSubstr("finite"));
  EXPECT_THAT(error_of(with_object("shape = \"sphere\"\nradius_mm = \"2\"\n")),
              HasSubstr("expected a number"));
  EXPECT_THAT(error_of(with_object("shape = \"sphere\"\nradius_m = 2\n")), HasSubstr("radius_mm"));
  EXPECT_THAT(error_of(with_object("shape = \"box\"\nsize_mm = [1, 2, 0]\n")),
              HasSubstr("size_mm[2]"));
  EXPECT_THAT(error_of(with_object("shape = \"box\"\nsize_mm = [1, 2, 3]\nedge_radius_mm = 0.6\n")),
              AllOf(HasSubstr("edge_radius_mm"), HasSubstr("0.5")));
  EXPECT_EQ(
      error_of(with_object("shape = \"box\"\nsize_mm = [0.7, 2, 3]\nedge_radius_mm = 0.35\n")),
      "no error");
  EXPECT_THAT(error_of(with_object("shape = \"plane\"\nradius_mm = 1\n")),
              HasSubstr("unknown key 'radius_mm'"));
  EXPECT_THAT(error_of(with_object("shape = \"plane\"\nfriction_coefficient = -0.1\n")),
              HasSubstr("friction_coefficient"));
  EXPECT_THAT(error_of(with_object("name = \"a\"\nshape = \"plane\"\n[[object]]\nname = \"a\"\n"
                                   "shape = \"plane\"\n")),
              HasSubstr("named 'a'"));
}

// The scenes that come with the program: at least 8 s, from rest to rest, no slip of the pen.
TEST(SceneFile, ShippedScenesAreUnhurriedAndBeginAndEndAloft) {
  for (const char* name : {"plane", "edge", "sphere"}) {
    const auto file =
        std::filesystem::path(source_folder()) / "scenes" / (std::string(name) + ".toml");
    const Scene scene = load_scene(file);
    ASSERT_EQ(scene.fingers.size(), 1u) << name;
    ASSERT_EQ(scene.objects.size(), 1u) << name;
    EXPECT_FALSE(scene.description.empty());
    EXPECT_TRUE(std::filesystem::exists(scene.fingers[0].model)) << name;
    EXPECT_TRUE(std::filesystem::exists(*scene.fingers[0].device)) << name;
    const Trajectory motion(scene.fingers[0].waypoints);
    EXPECT_EQ(motion.start_time(), 0.0);
    EXPECT_GE(motion.end_time(), 8.0) << name;
    const Shape& shape = scene.objects[0].shape;
    const Pose X_OW = scene.objects[0].motion.sample(0.0).inverse();
    const auto height = [&](double t) {
      return signed_distance(shape, X_OW * motion.sample(t).translation).distance;
    };
    // F's origin lies 7.3 mm above the lowest skin.
    EXPECT_GT(height(0.0), 0.019) << name;
    EXPECT_GT(height(motion.end_time()), 0.019) << name;
    double lowest = 1.0;
    for (double t = 0.0; t <= motion.end_time(); t += 1e-3) {
      const double h = height(t);
      lowest = std::min(lowest, h);
      const double speed = motion.sample_motion(t).velocity.norm();
      EXPECT_LT(speed, 0.06) << name << " at " << t;
    }
    EXPECT_LT(lowest, 0.006) << name;
    EXPECT_GT(lowest, 0.004) << name;
  }
}

}  // namespace
}  // namespace softfinger
