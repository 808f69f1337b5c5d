// Sliders and hinges with what acts on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "play.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/geometry/mass_properties.hpp"
#include "softfinger/world/body_tree.hpp"
#include "softfinger/world/joint_law.hpp"

namespace softfinger {
namespace {

const JointCurve kSnap{{0.0, 1.0 * mm, 1.4 * mm, 2.5 * mm}, {0.0, 1.2, 0.7, 2.5}};

Joint slider(double from, double to) {
  Joint joint{.kind = JointKind::kSlider};
  joint.limits = {from, to};
  return joint;
}

VirtualObject button(double mass) {
  VirtualObject object = loose("button", RoundedBox{Vector3(8, 8, 3) * mm, 0.5 * mm},
                               Vector3(0.0, 0.0, -3.0 * mm), mass);
  Joint joint = slider(-2.5 * mm, 0.0);
  joint.curve = kSnap;
  object.dynamics->joint = joint;
  return object;
}

TEST(Button, PressedSlowlyFollowsItsCurve) {
  // Pushed by a rigid plate that hangs on the world and goes down by script.
  VirtualObject pushed = button(20e-3);
  VirtualObject plate = still("plate", RoundedBox{Vector3(20, 20, 5) * mm, 0.5 * mm});
  const auto at = [](double z) { return Pose{Matrix3::Identity(), Vector3(0.0, 0.0, z)}; };
  plate.motion = Trajectory(std::vector<Waypoint>{{0.0, at(5.05 * mm)}, {4.0, at(2.75 * mm)}});
  Joint joint = *pushed.dynamics->joint;
  const JointLaw law(joint, 1.0);
  Play play({pushed, plate}, Vector3::Zero());
  double deepest = 0.0;
  while (play.time() < 4.0) {
    play.step();
    const double plate_at = plate.motion.sample(play.time()).translation.z() - 5.0 * mm;
    if (plate_at > -1e-5) continue;
    // It stays on the plate where the curve pushes it up.
    EXPECT_NEAR(play.state(0).joint, plate_at, 2e-6) << play.time();
    deepest = std::min(deepest, play.state(0).joint);
  }
  EXPECT_LT(deepest, -2.2 * mm);
  EXPECT_EQ(play.unconverged(), 0);
}

TEST(Button, SnapsOnceItIsPressedBeyondTheTop) {
  // A weight of 1.25 N passes the top of 1.2 N and goes on to where the curve carries it again.
  VirtualObject pressed = button(125e-3 / 0.981);
  pressed.dynamics->joint->damping = 20.0;
  Play play({pressed});
  play.run(1.0);
  const JointLaw law(*pressed.dynamics->joint, 1.0);
  EXPECT_LT(play.state(0).joint, -1.4 * mm);
  EXPECT_NEAR(-law.evaluate(play.state(0).joint).force, 1.25, 2e-3);
  EXPECT_LT(std::abs(play.state(0).velocity.z()), 0.02);
}

TEST(Button, TooLightForItsCurveSaysWhichMassWouldDo) {
  try {
    Play play({button(0.5e-3)});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("object 'button': its curve falls too steeply"),
              std::string::npos)
        << error.what();
  }
}

TEST(Knob, RestsInItsDetentsAndItsFrictionHoldsIt) {
  VirtualObject knob =
      loose("knob", RoundedCylinder{15.0 * mm, 8.0 * mm, 1.0 * mm}, Vector3::Zero(), 30e-3);
  Joint hinge{.kind = JointKind::kHinge};
  hinge.detents = {24, 4e-3};
  hinge.damping = 2e-5;
  knob.dynamics->joint = hinge;
  knob.dynamics->angular_velocity_W = Vector3(0.0, 0.0, 40.0);
  Play play({knob});
  play.run(3.0);
  const double pitch = 2.0 * std::numbers::pi / 24.0;
  EXPECT_GT(std::abs(play.state(0).joint), pitch);
  const double part = play.state(0).joint / pitch;
  EXPECT_NEAR(part, std::round(part), 1e-3);

  // Dry friction stops evenly: I d(omega)/dt = -T.
  knob.dynamics->joint = Joint{.kind = JointKind::kHinge, .friction = 1e-3};
  knob.dynamics->angular_velocity_W = Vector3(0.0, 0.0, 20.0);
  Play braked({knob});
  const MassProperties even = *mass_properties(knob.shape);
  const double inertia =
      inertia_about(*knob.dynamics->joint,
                    {30e-3, Vector3::Zero(), Matrix3(30e-3 / even.volume * even.second_moment_O)});
  const double stops_after = inertia * 20.0 / 1e-3;
  braked.run(0.5 * stops_after);
  EXPECT_NEAR(braked.state(0).angular_velocity.z(), 10.0, kStep * 1e-3 / inertia);
  braked.run(stops_after);
  const double stopped_at = braked.state(0).joint;
  EXPECT_NEAR(stopped_at, 0.5 * 20.0 * stops_after, 0.02 * 10.0 * stops_after);
  braked.run(1.0);
  EXPECT_NEAR(braked.state(0).joint, stopped_at, 1e-6);
}

TEST(Slider, IsStoppedByItsLimits) {
  VirtualObject drawer =
      loose("drawer", RoundedBox{Vector3(30, 20, 10) * mm, 1.0 * mm}, Vector3::Zero(), 0.2);
  Joint joint = slider(-5.0 * mm, 40.0 * mm);
  joint.axis_O = Vector3::UnitX();
  drawer.dynamics->joint = joint;
  drawer.dynamics->velocity_W = Vector3(0.5, 3.0, 0.0);
  Play play({drawer});
  double furthest = 0.0;
  for (int k = 0; k < 500; ++k) {
    play.step();
    furthest = std::max(furthest, play.state(0).joint);
    EXPECT_LT(std::abs(play.state(0).X_WO.translation.y()), 1e-12);
  }
  EXPECT_GT(furthest, 39.9 * mm);
  EXPECT_LT(furthest, 40.0 * mm + 0.3 * mm);
  EXPECT_LE(play.state(0).joint, 40.01 * mm);
  EXPECT_EQ(play.unconverged(), 0);
}

/// A bob that hangs 100 mm below what holds it.
VirtualObject bob(JointKind kind) {
  VirtualObject object = loose("bob", Ball{5.0 * mm}, Vector3::Zero(), 20e-3);
  object.dynamics->joint =
      Joint{.kind = kind, .axis_O = Vector3::UnitY(), .point_O = Vector3(0.0, 0.0, 100.0 * mm)};
  return object;
}

TEST(StartVelocity, IsWhatTheJointAllows) {
  // The same swing, said by its turn and by the way of its centre.
  for (const JointKind kind : {JointKind::kHinge, JointKind::kBall}) {
    VirtualObject turned = bob(kind);
    turned.dynamics->angular_velocity_W = Vector3(0.0, 2.0, 0.0);
    Play play({turned});
    play.step();
    EXPECT_NEAR(play.state(0).velocity.x(), -2.0 * 100.0 * mm, 1e-3);
  }
  VirtualObject pushed = bob(JointKind::kHinge);
  pushed.dynamics->velocity_W = Vector3(-0.2, 0.7, 0.3);
  Play play({pushed});
  play.step();
  EXPECT_NEAR(play.state(0).velocity.x(), -0.2, 1e-3);
  EXPECT_NEAR(play.state(0).velocity.y(), 0.0, 1e-9);
}

TEST(StartVelocity, OfWhatHangsOnAMovingBodyIsItsBodys) {
  VirtualObject drawer =
      loose("drawer", RoundedBox{Vector3(30, 20, 10) * mm, 1.0 * mm}, Vector3::Zero(), 0.2);
  drawer.dynamics->joint = slider(-1.0, 1.0);
  drawer.dynamics->joint->axis_O = Vector3::UnitX();
  drawer.dynamics->velocity_W = Vector3(0.5, 0.0, 0.0);
  VirtualObject handle = loose("handle", Ball{5.0 * mm}, Vector3(40.0 * mm, 0.0, 0.0), 0.2);
  handle.dynamics->joint = Joint{.kind = JointKind::kFixed, .parent = 0};
  Play play({drawer, handle}, Vector3::Zero());
  play.run(0.1);
  EXPECT_NEAR(play.state(0).velocity.x(), 0.5, 1e-9);
  EXPECT_NEAR(play.state(1).X_WO.translation.x(), 40.0 * mm + 0.05, 1e-9);
}

}  // namespace
}  // namespace softfinger
