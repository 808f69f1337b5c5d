// Objects that a person takes: a spring pulls them to where they are wanted, no harder than a hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "play.hpp"

namespace softfinger {
namespace {

constexpr double kRate = 2.0 * std::numbers::pi * 10.0;  // of a hold, rad/s
constexpr double kMass = 0.05;
const Vector3 kWeightless = Vector3::Zero();

/// A ball of 50 g in the air, and whatever else.
class Taken {
 public:
  explicit Taken(const Vector3& gravity, const std::vector<VirtualObject>& more = {},
                 double speed = 0.0) {
    objects_.push_back(loose("ball", Ball{10e-3}, Vector3::Zero(), kMass));
    objects_.front().dynamics->velocity_W.x() = speed;
    objects_.insert(objects_.end(), more.begin(), more.end());
    world_.emplace(objects_, gravity, kStep);
    world_->reset();
  }
  void hold(const Pose& X_WO, std::size_t o = 0) { world_->hold(o, &X_WO); }
  void let_go(std::size_t o = 0) { world_->hold(o, nullptr); }
  void run(double seconds) {
    for (const int end = steps_ + static_cast<int>(std::lround(seconds / kStep)); steps_ < end;) {
      step();
    }
  }
  void step() {
    world_->begin_step(kStep * ++steps_);
    world_->solve({}, {});
    EXPECT_TRUE(world_->summary().converged);
  }
  [[nodiscard]] const ObjectState& state(std::size_t o = 0) const { return world_->state(o); }
  [[nodiscard]] std::uint64_t hash() const { return world_->state_hash(); }

 private:
  std::vector<VirtualObject> objects_;
  std::optional<World> world_;
  int steps_ = 0;
};

Pose placed(double x, double y, double z, double turn = 0.0) {
  return {exp_rotation(Vector3(0.0, 0.0, turn)), Vector3(x, y, z)};
}

TEST(TakenObject, ComesWhereItIsWantedAndHangsByItsWeight) {
  Taken ball(kDown);
  ball.hold(placed(0.03, 0.02, 0.05, 0.8));
  ball.run(2.0);
  const Vector3 sag(0.0, 0.0, -kGravity / (kRate * kRate));
  EXPECT_LT((ball.state().X_WO.translation - Vector3(0.03, 0.02, 0.05) - sag).norm(), 1e-7);
  EXPECT_LT((ball.state().X_WO.rotation - exp_rotation(Vector3(0.0, 0.0, 0.8))).norm(), 1e-6);
  EXPECT_LT(ball.state().velocity.norm(), 1e-6);
}

TEST(TakenObject, ComesToRestAsACriticallyDampedSpringLetsIt) {
  constexpr double kSpeed = 0.05;
  Taken ball(kWeightless, {}, kSpeed);
  ball.hold(placed(0.0, 0.0, 0.0));
  double time = 0.0;
  for (const double next : {0.01, 0.02, 0.04, 0.1}) {
    ball.run(next - time);
    time = next;
    // Steps of 1 ms are a sixteenth of the spring's time.
    EXPECT_NEAR(ball.state().X_WO.translation.x(), kSpeed * time * std::exp(-kRate * time),
                0.06 * kSpeed / kRate)
        << time;
  }
}

TEST(TakenObject, FliesOnAsItMovedWhenLetGo) {
  Taken ball(kWeightless);
  for (int k = 1; k <= 500; ++k) {
    ball.hold(placed(0.4 * kStep * k, 0.0, 0.0));
    ball.step();
  }
  const Vector3 velocity = ball.state().velocity;
  EXPECT_NEAR(velocity.x(), 0.4, 1e-3);
  ball.let_go();
  ball.run(0.2);
  EXPECT_LT((ball.state().velocity - velocity).norm(), 1e-9);
}

TEST(TakenObject, IsPulledNoHarderThanAHandPulls) {
  // Through a wall: what presses on it is the hold's limit.
  Taken ball(kWeightless, {still("wall", HalfSpace{}, Vector3(0.0, 0.0, -11e-3), 0.0)});
  ball.hold(placed(0.0, 0.0, -0.5));
  ball.run(0.5);
  EXPECT_GT(ball.state().X_WO.translation.z(), -1.2e-3) << "it is not drawn through";
  EXPECT_LT(ball.state().X_WO.translation.z(), -0.9e-3);
  // In the air the limit accelerates it.
  Taken free(kWeightless);
  free.hold(placed(0.9, 0.0, 0.0));
  free.step();
  EXPECT_LE(free.state().velocity.x(), 5.0 / kMass * kStep * (1.0 + 1e-9));
  EXPECT_GT(free.state().velocity.x(), 0.99 * 5.0 / kMass * kStep);
}

TEST(TakenObject, OnAJointMovesAsTheJointLetsIt) {
  VirtualObject drawer =
      loose("drawer", RoundedBox{Vector3(20, 20, 10) * mm, 1.0 * mm}, Vector3(0.2, 0.0, 0.0), 0.1);
  drawer.dynamics->joint = Joint{
      .kind = JointKind::kSlider, .axis_O = Vector3::UnitX(), .limits = std::array{0.0, 0.05}};
  Taken both(kDown, {drawer});
  both.hold(placed(0.23, 0.04, 0.1), 1);
  both.run(1.0);
  EXPECT_NEAR(both.state(1).joint, 0.03, 1e-4);
  EXPECT_LT((both.state(1).X_WO.translation - Vector3(0.23, 0.0, 0.0)).norm(), 1e-4);
  both.hold(placed(0.4, 0.0, 0.0), 1);
  both.run(1.0);
  EXPECT_NEAR(both.state(1).joint, 0.05, 1e-3) << "its limit";
}

/// A door of 100 g whose hinge is upright, 40 mm from its middle.
VirtualObject door() {
  VirtualObject object =
      loose("door", RoundedBox{Vector3(40, 2, 30) * mm, 0.5 * mm}, Vector3(0.3, 0.0, 0.0), 0.1);
  object.dynamics->joint = Joint{.kind = JointKind::kHinge, .point_O = Vector3(-0.04, 0.0, 0.0)};
  return object;
}
/// Where the door's middle is at an angle.
Pose opened(double angle) {
  const Pose turned{exp_rotation(Vector3(0.0, 0.0, angle)), Vector3::Zero()};
  return {turned.rotation, Vector3(0.26, 0.0, 0.0) + turned * Vector3(0.04, 0.0, 0.0)};
}

TEST(TakenObject, OnAHingeIsOpenedAndSwingsOn) {
  Taken both(kDown, {door()});
  both.hold(opened(1.2), 1);
  both.run(1.0);
  EXPECT_NEAR(both.state(1).joint, 1.2, 1e-5) << "its hinge bears its weight";
  // From beside the way that the hinge leaves: what pulls across it moves nothing.
  Pose above = opened(1.2);
  above.translation.z() += 0.05;
  both.hold(above, 1);
  both.run(0.5);
  EXPECT_NEAR(both.state(1).joint, 1.2, 1e-5);
  EXPECT_NEAR(both.state(1).X_WO.translation.z(), 0.0, 1e-9);
  // Drawn shut at an even rate, then let go: it swings on.
  for (int k = 1; k <= 500; ++k) {
    both.hold(opened(1.2 - 1.0 * kStep * k), 1);
    both.step();
  }
  EXPECT_NEAR(both.state(1).angular_velocity.z(), -1.0, 1e-3);
  const double spin = both.state(1).angular_velocity.z();
  const double at = both.state(1).joint;
  both.let_go(1);
  both.run(0.5);
  EXPECT_NEAR(both.state(1).angular_velocity.z(), spin, 1e-6);
  EXPECT_NEAR(both.state(1).joint, at + 0.5 * spin, 1e-4);
}

TEST(TakenObject, OfDetentsClicksIntoTheNearestWhenLetGo) {
  constexpr double kApart = 2.0 * std::numbers::pi / 24.0;
  VirtualObject knob =
      loose("knob", RoundedCylinder{15.0 * mm, 8.0 * mm, 1.0 * mm}, Vector3(0.2, 0.0, 0.0), 0.05);
  knob.dynamics->joint = Joint{.kind = JointKind::kHinge,
                               .damping = 2e-4,
                               .detents = JointDetents{.count = 24, .torque = 4e-3}};
  Taken both(kDown, {knob});
  for (int k = 1; k <= 1000; ++k) {
    both.hold(placed(0.2, 0.0, 0.0, 3.3 * kApart * kStep * k), 1);
    both.step();
  }
  EXPECT_GT(both.state(1).joint, 2.7 * kApart);
  EXPECT_LT(both.state(1).joint, 3.3 * kApart) << "drawn back by its detent";
  both.let_go(1);
  both.run(1.0);
  EXPECT_NEAR(both.state(1).joint, 3.0 * kApart, 1e-4);
}

TEST(TakenObject, OnABallTurnsWhereItIsWantedAndFallsBack) {
  VirtualObject lamp =
      loose("lamp", RoundedBox{Vector3(5, 5, 40) * mm, 0.5 * mm}, Vector3(0.3, 0.0, -0.04), 0.05);
  lamp.dynamics->joint = Joint{.kind = JointKind::kBall, .point_O = Vector3(0.0, 0.0, 0.04)};
  Taken both(kDown, {lamp});
  const Vector3 pivot(0.3, 0.0, 0.0);
  const Pose turned{exp_rotation(Vector3(0.5, 0.3, 0.2)), Vector3::Zero()};
  const Pose X_WT{turned.rotation, pivot + turned * Vector3(0.0, 0.0, -0.04)};
  both.hold(X_WT, 1);
  both.run(1.0);
  const ObjectState held = both.state(1);
  EXPECT_LT((held.X_WO * Vector3(0.0, 0.0, 0.04) - pivot).norm(), 1e-12) << "its ball";
  // Its weight turns it no further than it would draw down what is held freely.
  EXPECT_LT(log_rotation(held.X_WO.rotation * turned.rotation.transpose()).norm(),
            kGravity / (kRate * kRate) / 0.04);
  EXPECT_LT(held.velocity.norm(), 1e-6);
  both.let_go(1);
  double highest = held.X_WO.translation.z();
  double lowest = highest;
  for (int k = 0; k < 3000; ++k) {
    both.step();
    highest = std::max(highest, both.state(1).X_WO.translation.z());
    lowest = std::min(lowest, both.state(1).X_WO.translation.z());
  }
  EXPECT_LT(lowest, -0.0399) << "it swings through the lowest place";
  EXPECT_LT(highest, held.X_WO.translation.z() + 1e-6) << "and no higher than it was";
}

TEST(TakenObject, NextStepDependsOnWhereItIsHeld) {
  Taken ball(kDown), other(kDown);
  EXPECT_EQ(ball.hash(), other.hash());
  ball.hold(placed(0.0, 0.0, 0.01));
  EXPECT_NE(ball.hash(), other.hash());
  other.hold(placed(0.0, 0.0, 0.01));
  EXPECT_EQ(ball.hash(), other.hash());
}

}  // namespace
}  // namespace softfinger
