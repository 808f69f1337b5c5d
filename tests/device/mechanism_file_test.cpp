#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "../support/folders.hpp"
#include "mechanisms.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string shipped_text(const std::string& name) {
  std::ifstream file(source_folder() + "/devices/" + name + ".toml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::filesystem::path written(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) /
                                     ("mechanism_under_test_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << text;
  return file;
}

/// The text with `from`, where it comes first, replaced by `to`.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

/// What is said about a mechanism when it is refused.
std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(load_device(written(text)));
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THAT(message, testing::ContainsRegex("mechanism_under_test_[0-9]+\\.toml:[0-9]+: |"
                                                "mechanism_under_test_[0-9]+\\.toml: "));
    return message;
  }
  return {};
}

/// The five-bar with one thing changed.
std::string refusal_of_change(const std::string& from, const std::string& to) {
  return refusal_of(replaced(shipped_text("five-bar"), from, to));
}

TEST(MechanismFile, AcceptsWhatIsUnchanged) {
  EXPECT_EQ(refusal_of(shipped_text("five-bar")), "");
  EXPECT_EQ(refusal_of(shipped_text("thimble-3rrs-mechanism")), "");
  EXPECT_EQ(refusal_of(shipped_text("plate-6dof")), "");
}

TEST(MechanismFile, ReadsWhatTheFileSays) {
  const std::shared_ptr<const Device> device = mechanism("five-bar");
  EXPECT_EQ(device->degrees_of_freedom(), 2);
  EXPECT_EQ(device->axes()[0].name, "x_mm");
  EXPECT_EQ(device->joint_count(), 2);
  EXPECT_DOUBLE_EQ(device->joint_limits().max[1], 110.0 * deg);
  EXPECT_DOUBLE_EQ(device->joint_limits().max_rate, 400.0 * deg);
  EXPECT_EQ(device->approach_axis(), 1);
  EXPECT_EQ(device->constraint_names(0)[0], "joint_1");
  EXPECT_THAT(device->settings().as_read,
              AllOf(HasSubstr("\"proximal_knee\""), HasSubstr("\"joint_deg\"")));
}

TEST(MechanismFile, RefusesALoopThatDoesNotClose) {
  EXPECT_THAT(refusal_of_change("origin_b_mm = [24.0, 0.0, 0.0]", "origin_b_mm = [54.0, 7.0, 0.0]"),
              AllOf(HasSubstr("loop[0]"), HasSubstr("mm are left")));
}

TEST(MechanismFile, RefusesTheWrongNumberOfCoordinates) {
  const std::string without_rest = replaced(shipped_text("five-bar"), "z_mm = -3.0", "");
  EXPECT_THAT(
      refusal_of(replaced(without_rest, "z_mm = { body = \"tip\", coordinate = \"z\" }", "")),
      AllOf(HasSubstr("configuration"), HasSubstr("2 degrees of freedom")));
  EXPECT_THAT(refusal_of_change("z_mm = { body = \"tip\", coordinate = \"z\" }",
                                "z_mm = { body = \"tip\", coordinate = \"z\" }\n"
                                "pitch_deg = { body = \"tip\", coordinate = \"pitch\" }"),
              AllOf(HasSubstr("3 coordinates"), HasSubstr("2 degrees of freedom")));
  // The tip stays in its plane whatever the motors do.
  EXPECT_THAT(refusal_of_change("x_mm = { body = \"tip\", coordinate = \"x\" }",
                                "y_mm = { body = \"tip\", coordinate = \"y\" }"),
              HasSubstr("do not determine"));
}

TEST(MechanismFile, RefusesUnknownNamesAndSaysWhatIsNear) {
  EXPECT_THAT(refusal_of_change("parent = \"distal_crank\"", "parent = \"distal_krank\""),
              AllOf(HasSubstr("joint[1].parent"), HasSubstr("'distal_crank'")));
  EXPECT_THAT(refusal_of_change("body = \"tip\"\nradius_mm", "body = \"tap\"\nradius_mm"),
              AllOf(HasSubstr("surface[0].body"), HasSubstr("'tip'")));
  EXPECT_THAT(refusal_of_change("x_mm = { body = \"tip\", coordinate = \"x\" }",
                                "x_deg = { joint = \"distal_kne\" }"),
              AllOf(HasSubstr("configuration.x_deg.joint"), HasSubstr("'distal_knee'")));
}

TEST(MechanismFile, RefusesBodiesThatHangOnNothingOrTwice) {
  EXPECT_THAT(refusal_of_change("[[body]]\nname = \"tip\"",
                                "[[body]]\nname = \"tip\"\n\n[[body]]\nname = \"spare\""),
              AllOf(HasSubstr("body[3].name"), HasSubstr("no joint carries 'spare'")));
  EXPECT_THAT(refusal_of_change("child = \"proximal_coupler\"", "child = \"tip\""),
              AllOf(HasSubstr("joint[4].child"), HasSubstr("'tip_on_distal'")));
  EXPECT_THAT(refusal_of_change("parent = \"base\"", "parent = \"tip\""),
              AllOf(HasSubstr("joint[0].parent"), HasSubstr("[[loop]]")));
  EXPECT_THAT(refusal_of_change("child = \"tip\"", "child = \"base\""),
              HasSubstr("joint[2].child"));
  EXPECT_THAT(refusal_of_change("name = \"tip\"", "name = \"distal_crank\""),
              AllOf(HasSubstr("body[2].name"), HasSubstr("already")));
}

TEST(MechanismFile, RefusesAHomeOutOfTheLimits) {
  EXPECT_THAT(refusal_of_change("joint_deg = [10.0, 110.0]", "joint_deg = [65.0, 110.0]"),
              AllOf(HasSubstr("home"), HasSubstr("'distal_servo'"), HasSubstr("59.2")));
  EXPECT_THAT(refusal_of_change("[retract]", "[home]\nz_mm = 40.0\n\n[retract]"),
              AllOf(HasSubstr("home"), HasSubstr("do not close")));
  EXPECT_THAT(refusal_of_change("z_mm = -3.0", "z_mm = -30.0"), HasSubstr("retract"));
}

TEST(MechanismFile, RefusesWhatCannotBeRendered) {
  const std::string text = shipped_text("five-bar");
  const std::size_t surface = text.find("[[surface]]");
  const std::size_t configuration = text.find("[configuration]");
  EXPECT_THAT(refusal_of(text.substr(0, surface) + text.substr(configuration)),
              HasSubstr("surface"));
  EXPECT_THAT(refusal_of_change("radius_mm = 5.0", "radius_mm = 5.0\npins = 3"), HasSubstr("pins"));
  EXPECT_THAT(refusal_of_change("type = \"sphere\"", "type = \"spere\""), HasSubstr("sphere"));
}

TEST(MechanismFile, RefusesMotorsThatDoNotFit) {
  const std::string motor = "actuated = true\njoint_deg = [10.0, 110.0]\n";
  const std::string one = replaced(shipped_text("five-bar"), motor, "");
  const std::string with_one_servo = one.substr(0, one.rfind("[[transport.servo]]"));
  EXPECT_THAT(refusal_of(with_one_servo), AllOf(HasSubstr("1 actuated"), HasSubstr("2 degrees")));
  EXPECT_THAT(refusal_of(replaced(one, motor, "")), HasSubstr("actuated = true"));
  const std::string two = shipped_text("five-bar");
  EXPECT_THAT(refusal_of(two.substr(0, two.rfind("[[transport.servo]]"))),
              AllOf(HasSubstr("1 servos"), HasSubstr("this device has 2")));
  EXPECT_THAT(refusal_of_change("type = \"fixed\"", "type = \"fixed\"\nactuated = true"),
              HasSubstr("joint[2].actuated"));
  EXPECT_THAT(refusal_of_change("joint_deg = [10.0, 110.0]", "joint_deg = [110.0, 10.0]"),
              HasSubstr("joint_deg"));
}

TEST(MechanismFile, RefusesMoreThanItsCapacity) {
  std::string bodies = "kind = \"mechanism\"\n";
  std::string joints;
  for (int b = 0; b < 30; ++b) {
    const std::string name = "b" + std::to_string(b);
    bodies += "[[body]]\nname = \"" + name + "\"\n";
    joints += "[[joint]]\nname = \"j" + name +
              "\"\ntype = \"free\"\nparent = \"base\"\nchild = \"" + name + "\"\n";
  }
  EXPECT_THAT(refusal_of(bodies + joints), AllOf(HasSubstr("30 bodies"), HasSubstr("24")));
  const std::size_t many = bodies.find("[[body]]\nname = \"b20\"");
  EXPECT_THAT(refusal_of(bodies.substr(0, many) + joints),
              AllOf(HasSubstr("54 coordinates"), HasSubstr("48")));
  EXPECT_THAT(refusal_of_change("type = \"sphere\"\nbody = \"tip\"\nradius_mm = 5.0",
                                "type = \"pins\"\nbody = \"tip\"\nradius_mm = 0.5\nrows = 9\n"
                                "columns = 9\npitch_mm = 1.0"),
              AllOf(HasSubstr("81 pins"), HasSubstr("64")));
}

TEST(MechanismFile, RefusesWrongAxesAndUnits) {
  EXPECT_THAT(refusal_of_change("axis = [0.0, 1.0, 0.0]", "axis = [0.0, 0.0, 0.0]"),
              HasSubstr("joint[0].axis"));
  EXPECT_THAT(refusal_of_change("x_mm = {", "x_deg = {"), HasSubstr("must end in _mm"));
  EXPECT_THAT(refusal_of_change("body_b = \"proximal_coupler\"", "body_b = \"tip\""),
              HasSubstr("body_b"));
  EXPECT_THAT(refusal_of(replaced(shipped_text("plate-6dof"), "second_axis = [0.0, 0.0, 1.0]",
                                  "second_axis = [0.0, 1.0, 0.0]")),
              HasSubstr("second_axis"));
  EXPECT_THAT(refusal_of(replaced(shipped_text("plate-6dof"), "tilt_body = \"plate\"", "")),
              HasSubstr("tilt_body"));
}

// Every kind of joint and surface in one file: a slider that carries pins and a box.
TEST(MechanismFile, ReadsSlidersAndEverySurface) {
  const std::string text = R"(
kind = "mechanism"
[[body]]
name = "slider"
[[joint]]
name = "lift"
type = "prismatic"
parent = "base"
child = "slider"
axis = [0, 0, 1]
actuated = true
joint_mm = [-5, 5]
[[surface]]
type = "pins"
body = "slider"
radius_mm = 0.5
rows = 2
columns = 2
pitch_mm = 2.0
[[surface]]
type = "pins"
body = "slider"
origin_mm = [0, 6, 0]
radius_mm = 0.5
pin = [{ position_mm = [1, 0, 0] }]
[[surface]]
type = "box"
body = "slider"
origin_mm = [10, 0, -1]
size_mm = [4, 4, 2]
edge_radius_mm = 0.25
[[surface]]
type = "capsule"
body = "slider"
origin_mm = [20, 0, -1]
rotation_vector_deg = [90, 0, 0]
radius_mm = 1.0
length_mm = 4.0
[configuration]
lift_mm = { joint = "lift" }
[limits]
joint_rate_mm_per_s = 50
[matching]
approach = "lift_mm"
)";
  const auto device = load_device(written(text));
  EXPECT_EQ(device->solid_piece_count(), 7);
  EXPECT_EQ(device->approach_axis(), 0);
  Configuration q(1);
  q << 2.0 * mm;
  JointAngles joints;
  ASSERT_TRUE(device->inverse_kinematics(q, joints));
  EXPECT_NEAR(joints[0], 2.0 * mm, 1e-15);
  EXPECT_TRUE(device->reachable(q));
  q << 5.1 * mm;
  EXPECT_FALSE(device->reachable(q));
  q << 2.0 * mm;
  // Over a pin of the grid, between the grid's pins, over the lone pin, over box and capsule.
  const auto gap = [&](double x, double y, double z) {
    return device->signed_distance(q, Vector3(x, y, z) * mm).distance / mm;
  };
  EXPECT_NEAR(gap(1.0, 1.0, 3.0), 1.0, 1e-12);
  EXPECT_NEAR(gap(0.0, 1.0, 2.0), 0.5, 1e-12);
  EXPECT_NEAR(gap(1.0, 6.0, 2.5), 0.5, 1e-12);
  EXPECT_NEAR(gap(10.0, 0.0, 2.7), 0.7, 1e-12);
  EXPECT_NEAR(gap(20.0, 2.0, 2.4), 0.4, 1e-12);
  // To its end disk a sample in contact is where its solid alone is not.
  EXPECT_NEAR(device->closest_point_residual(q, Vector3(1.0, 1.0, 1.5) * mm).residual.norm(),
              0.5 * mm, 1e-15);
}

}  // namespace
}  // namespace softfinger
