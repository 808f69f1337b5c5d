// Objects of a scene file that move by the forces on them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "softfinger/base/error.hpp"
#include "softfinger/geometry/mass_properties.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

Scene load_text(const std::string& text) {
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const auto file = std::filesystem::path(testing::TempDir()) / (test + "_dynamic.toml");
  std::ofstream(file, std::ios::binary) << text;
  return load_scene(file);
}

std::string refusal_of(const std::string& text) {
  try {
    (void)load_text(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// A box that moves; its table stands in lines 1 to 4, what follows from line 5 on.
std::string box(const std::string& rest) {
  return "[[object]]\nshape = \"box\"\nsize_mm = [30, 30, 30]\nmotion = \"dynamic\"\n" + rest;
}

/// The same on a joint, whose keys begin in line 7 of the file.
std::string jointed(const std::string& keys) { return box("mass_g = 45\n[object.joint]\n" + keys); }
std::string slider(const std::string& keys) {
  return jointed("kind = \"slider\"\naxis = [0, 0, 2]\n" + keys);  // keys from line 9 on
}
std::string hinge(const std::string& keys) {
  return jointed("kind = \"hinge\"\naxis = [0, 0, 1]\n" + keys);
}

TEST(DynamicObject, FreeBodyHasMassAndVelocityInSi) {
  const Scene scene = load_text(box(R"(mass_g = 45.0
velocity_mm_per_s = [1, 2, 3]
angular_velocity_deg_per_s = [0, 90, 0]
position_mm = [0, 0, 20]
friction_coefficient = 0.4
[world]
gravity_m_per_s2 = [0, 1, -1.62]
)"));
  EXPECT_TRUE(scene.fingers.empty());
  EXPECT_EQ(scene.gravity, Vector3(0, 1, -1.62));
  ASSERT_EQ(scene.objects.size(), 1u);
  const VirtualObject& object = scene.objects[0];
  ASSERT_TRUE(object.dynamics);
  EXPECT_DOUBLE_EQ(object.dynamics->mass, 0.045);
  EXPECT_LT((object.dynamics->velocity_W - Vector3(1e-3, 2e-3, 3e-3)).norm(), 1e-15);
  EXPECT_LT((object.dynamics->angular_velocity_W - Vector3(0, 90 * kDegree, 0)).norm(), 1e-12);
  EXPECT_FALSE(object.dynamics->joint);
  EXPECT_EQ(object.motion.sample(0.0).translation, Vector3(0, 0, 0.02));
  EXPECT_EQ(object.friction_coefficient, 0.4);
}

TEST(DynamicObject, GravityPointsDownUnlessSaid) {
  EXPECT_EQ(load_text(box("mass_g = 1\n")).gravity, Vector3(0, 0, -9.81));
}

TEST(DynamicObject, MassByDensityIsThatOfTheRoundedShape) {
  const Scene scene = load_text(box("density_kg_per_m3 = 1000\nedge_radius_mm = 5\n"));
  const double volume = mass_properties(scene.objects[0].shape)->volume;
  EXPECT_LT(volume, 27e-6);
  EXPECT_DOUBLE_EQ(scene.objects[0].dynamics->mass, 1000.0 * volume);
}

TEST(DynamicObject, SliderInSi) {
  const Joint joint = *load_text(slider(R"(point_mm = [1, 2, 3]
limits_mm = [-2.5, 0]
spring_N_per_mm = 0.5
rest_mm = -0.5
damping_N_s_per_mm = 0.001
friction_N = 0.2
)"))
                           .objects[0]
                           .dynamics->joint;
  EXPECT_EQ(joint.kind, JointKind::kSlider);
  EXPECT_EQ(joint.parent, -1);
  EXPECT_EQ(joint.axis_O, Vector3::UnitZ());
  EXPECT_LT((joint.point_O - Vector3(1e-3, 2e-3, 3e-3)).norm(), 1e-15);
  EXPECT_DOUBLE_EQ((*joint.limits)[0], -2.5e-3);
  EXPECT_DOUBLE_EQ((*joint.limits)[1], 0.0);
  EXPECT_DOUBLE_EQ(joint.spring, 500.0);
  EXPECT_DOUBLE_EQ(joint.rest, -0.5e-3);
  EXPECT_DOUBLE_EQ(joint.damping, 1.0);
  EXPECT_DOUBLE_EQ(joint.friction, 0.2);
}

TEST(DynamicObject, HingeInSiAndOverFullTurns) {
  const Joint joint = *load_text(hinge(R"(limits_deg = [-720, 720]
spring_N_mm_per_rad = 10
rest_deg = 360
damping_N_mm_s_per_rad = 0.5
friction_N_mm = 2
[object.joint.detents]
count = 24
torque_N_mm = 4
)"))
                           .objects[0]
                           .dynamics->joint;
  EXPECT_EQ(joint.kind, JointKind::kHinge);
  EXPECT_NEAR((*joint.limits)[1], 4.0 * std::numbers::pi, 1e-12);
  EXPECT_DOUBLE_EQ(joint.spring, 0.01);
  EXPECT_NEAR(joint.rest, 2.0 * std::numbers::pi, 1e-12);
  EXPECT_DOUBLE_EQ(joint.damping, 0.5e-3);
  EXPECT_DOUBLE_EQ(joint.friction, 2e-3);
  ASSERT_TRUE(joint.detents);
  EXPECT_EQ(joint.detents->count, 24);
  EXPECT_DOUBLE_EQ(joint.detents->torque, 4e-3);
}

TEST(DynamicObject, CurveOfASlider) {
  const Joint joint = *load_text(slider("[object.joint.curve]\ntravel_mm = [0, 1, 1.4, 2.5]\n"
                                        "force_N = [0, 1.2, 0.7, 2.5]\n"))
                           .objects[0]
                           .dynamics->joint;
  ASSERT_TRUE(joint.curve);
  ASSERT_EQ(joint.curve->travel.size(), 4u);
  EXPECT_DOUBLE_EQ(joint.curve->travel[2], 1.4e-3);
  EXPECT_THAT(joint.curve->force, testing::ElementsAre(0.0, 1.2, 0.7, 2.5));
}

TEST(DynamicObject, HangsOnAnObjectByNameWhereverThatStands) {
  const Scene scene = load_text(box("name = \"lid\"\nmass_g = 1\n[object.joint]\nkind = \"ball\"\n"
                                    "point_mm = [0, 0, 15]\nparent = \"sphere\"\n") +
                                box("name = \"knob\"\nmass_g = 1\n[object.joint]\n"
                                    "kind = \"fixed\"\nparent = \"lid\"\n") +
                                "[[object]]\nshape = \"sphere\"\nradius_mm = 5\n");
  EXPECT_EQ(scene.objects[0].dynamics->joint->parent, 2);
  EXPECT_EQ(scene.objects[0].dynamics->joint->point_O, Vector3(0, 0, 0.015));
  EXPECT_EQ(scene.objects[1].dynamics->joint->parent, 0);
}

TEST(DynamicObject, NeedsOneMassInRange) {
  EXPECT_THAT(refusal_of(box("")),
              AllOf(HasSubstr(": object[0].mass_g: "), HasSubstr("density_kg_per_m3")));
  EXPECT_THAT(refusal_of(box("mass_kg = 1\n")),
              AllOf(HasSubstr(":5: object[0].mass_kg"), HasSubstr("'mass_g'")));
  EXPECT_THAT(refusal_of(box("mass_g = 1\ndensity_kg_per_m3 = 1000\n")),
              AllOf(HasSubstr(":6: object[0].density_kg_per_m3"), HasSubstr("mass_g")));
  EXPECT_THAT(refusal_of(box("mass_g = 0.0009\n")), HasSubstr(":5: object[0].mass_g"));
  EXPECT_THAT(refusal_of(box("mass_g = 100001\n")), HasSubstr(":5: object[0].mass_g"));
  EXPECT_EQ(refusal_of(box("mass_g = 0.001\n")), "no error");
  EXPECT_THAT(refusal_of("[[object]]\nshape = \"sphere\"\nradius_mm = 0.1\nmotion = \"dynamic\"\n"
                         "density_kg_per_m3 = 10\n"),
              AllOf(HasSubstr(":5: object[0].density_kg_per_m3"), HasSubstr("4.19e-08 g")));
}

TEST(DynamicObject, SaysWhatCannotMoveByForces) {
  EXPECT_THAT(refusal_of("[[object]]\nshape = \"plane\"\nmotion = \"dynamic\"\nmass_g = 1\n"),
              AllOf(HasSubstr(":3: object[0].motion"), HasSubstr("plane")));
  EXPECT_THAT(refusal_of(box("mass_g = 1\n[[object.waypoint]]\ntime_s = 0\n")),
              AllOf(HasSubstr("object[0].waypoint"), HasSubstr("dynamic")));
  const std::string still = "[[object]]\nshape = \"sphere\"\nradius_mm = 5\n";
  for (const char* key : {"mass_g = 1", "density_kg_per_m3 = 1", "velocity_mm_per_s = [0, 0, 0]",
                          "angular_velocity_deg_per_s = [0, 0, 0]", "joint = {kind = \"ball\"}"}) {
    const std::string name(key, std::string(key).find(' '));
    EXPECT_THAT(refusal_of(still + key + "\n"),
                AllOf(HasSubstr(":4: object[0]." + name), HasSubstr("motion = \"dynamic\"")));
  }
  EXPECT_THAT(refusal_of(box("motion = \"free\"\n")), HasSubstr("twice"));
  EXPECT_THAT(refusal_of(still + "motion = \"dynamik\"\n"), HasSubstr("'dynamic'"));
  EXPECT_THAT(refusal_of(still), HasSubstr("at least one [[finger]]"));
}

TEST(DynamicObject, AtMost64) {
  std::string text;
  for (int i = 0; i < 64; ++i) text += box("mass_g = 1\n");
  EXPECT_EQ(refusal_of(text), "no error");
  EXPECT_THAT(refusal_of(text + box("mass_g = 1\n")),
              AllOf(HasSubstr("object[64].motion"), HasSubstr("64")));
}

TEST(DynamicObject, ParentsAreKnownAndMakeNoLoop) {
  const auto on = [](const std::string& name, const std::string& parent) {
    return box("name = \"" + name + "\"\nmass_g = 1\n[object.joint]\nkind = \"ball\"\nparent = \"" +
               parent + "\"\n");
  };
  EXPECT_THAT(refusal_of(on("a", "panel") + "[[object]]\nname = \"panels\"\nshape = \"plane\"\n"),
              AllOf(HasSubstr(":9: object[0].joint.parent"), HasSubstr("'panels'")));
  EXPECT_THAT(refusal_of(on("a", "a")),
              AllOf(HasSubstr(":9: object[0].joint.parent"), HasSubstr("itself")));
  EXPECT_THAT(refusal_of(on("a", "b") + on("b", "c") + on("c", "a")),
              AllOf(HasSubstr(":27: object[2].joint.parent"), HasSubstr("loop")));
  // Hanging on a loop is no loop of one's own, but ends as well.
  EXPECT_THAT(refusal_of(on("x", "a") + on("a", "b") + on("b", "a")), HasSubstr("loop"));
}

TEST(DynamicObject, KeysOfAnotherKindOfJointAreToldWhoseTheyAre) {
  const auto on = [](const char* key) { return AllOf(HasSubstr(key), HasSubstr("joint of kind")); };
  EXPECT_THAT(refusal_of(slider("limits_deg = [-1, 0]\n")), on(":9: object[0].joint.limits_deg"));
  EXPECT_THAT(refusal_of(slider("spring_N_mm_per_rad = 1\n")), on("hinge, not slider"));
  EXPECT_THAT(refusal_of(slider("detents = {count = 2, torque_N_mm = 1}\n")),
              on(":9: object[0].joint.detents"));
  EXPECT_THAT(refusal_of(hinge("friction_N = 1\n")), on(":9: object[0].joint.friction_N"));
  EXPECT_THAT(refusal_of(hinge("curve = {travel_mm = [0, 1], force_N = [0, 1]}\n")),
              on("slider, not hinge"));
  EXPECT_THAT(refusal_of(jointed("kind = \"ball\"\naxis = [0, 0, 1]\n")), on("slider or hinge"));
  EXPECT_THAT(refusal_of(jointed("kind = \"fixed\"\npoint_mm = [0, 0, 1]\n")), on("not fixed"));
  EXPECT_THAT(refusal_of(slider("limit_mm = [0, 1]\n")), HasSubstr("'limits_mm'"));
  EXPECT_THAT(refusal_of(jointed("kind = \"hinges\"\n")), HasSubstr("'hinge'"));
}

TEST(DynamicObject, JointsThatCannotBe) {
  EXPECT_THAT(refusal_of(slider("limits_mm = [1, -1]\n")),
              AllOf(HasSubstr(":9: object[0].joint.limits_mm"), HasSubstr("found 1 and -1")));
  EXPECT_THAT(refusal_of(hinge("limits_deg = [10, 20]\n")),
              AllOf(HasSubstr(":9: object[0].joint.limits_deg"), HasSubstr("found 10 and 20")));
  EXPECT_THAT(refusal_of(hinge("limits_deg = [-10, 20]\nrest_deg = 30\n")),
              AllOf(HasSubstr(":10: object[0].joint.rest_deg"), HasSubstr("found 30")));
  EXPECT_THAT(refusal_of(jointed("kind = \"slider\"\naxis = [0, 0, 0]\n")),
              HasSubstr(":8: object[0].joint.axis"));
  EXPECT_THAT(refusal_of(jointed("kind = \"slider\"\n")), HasSubstr("object[0].joint.axis"));
  EXPECT_THAT(refusal_of(slider("spring_N_per_mm = -1\n")), HasSubstr("spring_N_per_mm"));
  EXPECT_THAT(refusal_of(slider("limits_mm = [0]\n")), HasSubstr("2 numbers"));
}

TEST(DynamicObject, CurvesThatCannotBe) {
  const auto curve = [](const char* travel, const char* force) {
    return slider(std::string("[object.joint.curve]\ntravel_mm = ") + travel +
                  "\nforce_N = " + force + "\n");
  };
  EXPECT_THAT(refusal_of(curve("[0, 1, 1]", "[0, 1, 2]")),
              AllOf(HasSubstr(":10: object[0].joint.curve.travel_mm"), HasSubstr("1 after 1")));
  EXPECT_THAT(refusal_of(curve("[0, 1, 2]", "[0, 1]")),
              AllOf(HasSubstr(":11: object[0].joint.curve.force_N"), HasSubstr("found 2")));
  EXPECT_THAT(refusal_of(curve("[0]", "[0]")), HasSubstr("curve.travel_mm"));
  EXPECT_THAT(refusal_of(curve("[0, nan]", "[0, 1]")), HasSubstr("finite"));
  EXPECT_THAT(refusal_of(slider("spring_N_per_mm = 1\n[object.joint.curve]\ntravel_mm = [0, 1]\n"
                                "force_N = [0, 1]\n")),
              AllOf(HasSubstr("object[0].joint.curve"), HasSubstr("spring_N_per_mm")));
  EXPECT_THAT(refusal_of(hinge("detents = {count = 0, torque_N_mm = 1}\n")),
              HasSubstr("object[0].joint.detents.count"));
}

}  // namespace
}  // namespace softfinger
