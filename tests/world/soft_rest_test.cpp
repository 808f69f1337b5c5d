// Soft objects at rest sleep as rigid ones do, beside them and with them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sleeping_in_both.hpp"
#include "soft_box.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

const Vector3 kSponge = Vector3(30, 30, 20) * mm;
constexpr double kTop = 20.0 * mm;  // of a sponge on the ground, at rest

VirtualObject sponge(const Vector3& at, bool held = false) {
  return soft("sponge", soft_box(kSponge, {3, 3, 2}, 20e3, 0.3, 200.0, held), at);
}

/// On the ground at z = 0, where it has yet to sink under its weight.
VirtualObject lying_sponge(double x = 0.0) { return sponge(Vector3(x, 0.0, 0.5 * kSponge.z())); }

VirtualObject ground(const std::vector<Waypoint>& waypoints = {}) {
  VirtualObject object = still("ground", HalfSpace{});
  if (!waypoints.empty()) object.motion = Trajectory(waypoints);
  return object;
}

Waypoint ground_at(double time, const Vector3& at) { return {time, {Matrix3::Identity(), at}}; }

VirtualObject little_cube(const Vector3& at) {
  return loose("cube", RoundedBox{Vector3::Constant(5.0 * mm), 0.5 * mm}, at, 0.005);
}

TEST(SoftRest, CostsNothingAndStays) {
  Play play({lying_sponge(), ground()});
  play.run(0.4);
  EXPECT_EQ(play.world().work().sleeping, 0U) << "not before its time";
  play.run(2.0);
  ASSERT_EQ(play.world().work().sleeping, 1U);
  EXPECT_EQ(play.state(0).velocity, Vector3::Zero());
  const Vector3 corner = play.world().nodes(0).back();
  const std::uint64_t hash = play.world().state_hash();
  const std::size_t events = play.events().size();
  for (int k = 0; k < 1000; ++k) {
    play.step();
    ASSERT_EQ(play.world().work().sleeping, 1U);
    ASSERT_EQ(play.world().work().islands, 0U);
    ASSERT_EQ(play.world().summary().iterations, 0);
  }
  EXPECT_EQ(play.world().nodes(0).back(), corner);
  EXPECT_EQ(play.world().state_hash(), hash);
  EXPECT_EQ(play.events().size(), events) << "the ground has not let it go";
}

TEST(SoftRest, DoesNotBeginWhileItIsSlow) {
  // Skin that goes on yielding: by some micrometres a second.
  auto solid = std::make_shared<SoftSolid>(*soft_box(kSponge, {3, 3, 2}, 2e3, 0.3, 200.0));
  solid->relaxation.terms = {{.fraction = 0.3, .time = 5.0}};
  Play play({soft("dough", solid, Vector3(0.0, 0.0, 0.5 * kSponge.z())), ground()});
  play.run(2.0);
  EXPECT_EQ(play.world().work().sleeping, 0U);
  const double before = play.state(0).X_WO.translation.z();
  play.run(1.0);
  EXPECT_LT(play.state(0).X_WO.translation.z(), before - 1e-6);
}

/// Force of a finger that comes down from `height` above the surface, waits there until `start`,
/// and presses by 2 mm.
std::vector<double> pressed(double height, double start, std::size_t& sleeping) {
  const auto path = [=](double time) {
    const double way = (2.0 * mm + height) * smooth(time, start, start + 0.3);
    return Pose{Matrix3::Identity(), Vector3(0.0, 0.0, kTop + kPad + height - way)};
  };
  Play play({lying_sponge(), ground()}, kDown, {path});
  play.run(start);
  sleeping = play.world().work().sleeping;
  std::vector<double> forces;
  for (int k = 0; k < 500; ++k) {
    play.step();
    forces.push_back(play.finger(0).contact().normal_force);
    if (forces.back() > 0.0) {
      EXPECT_EQ(play.world().work().sleeping, 0U) << play.time();
    }
  }
  EXPECT_EQ(play.unconverged(), 0);
  return forces;
}

TEST(SoftRest, EndsBeforeAFingerTouches) {
  // Once from where it lets the sponge sleep, once from where it does not.
  std::size_t asleep = 0;
  std::size_t awake = 0;
  const double after_sleep = pressed(15.0 * mm, 2.5, asleep).back();
  const double after_waking = pressed(3.0 * mm, 2.5, awake).back();
  EXPECT_EQ(asleep, 1U);
  EXPECT_EQ(awake, 0U);
  ASSERT_GT(after_waking, 0.05);
  EXPECT_NEAR(after_sleep, after_waking, 1e-3 * after_waking);
}

TEST(SoftRest, IsSharedWithWhatLiesOnIt) {
  std::vector<VirtualObject> objects{lying_sponge(), ground(),
                                     little_cube(Vector3(0.0, 0.0, kTop + 5.0 * mm)),
                                     little_cube(Vector3(60.0 * mm, 0.0, 5.0 * mm))};
  World world(objects, kDown, kStep);
  world.reset();
  int steps = 0;
  const auto run = [&](int count) {
    for (const int end = steps + count; steps < end;) {
      world.begin_step(kStep * ++steps);
      world.solve({}, {});
    }
  };
  run(3000);
  ASSERT_EQ(world.work().sleeping, 3U);
  const double sunk = world.state(2).X_WO.translation.z();
  const Vector3 middle = world.state(0).X_WO.translation;
  const Pose X_WT{Matrix3::Identity(), Vector3(0.0, 0.0, 60.0 * mm)};
  world.hold(2, &X_WT);
  run(1);
  EXPECT_EQ(world.work().sleeping, 1U) << "the cube that lies apart";
  run(300);
  EXPECT_GT(world.state(2).X_WO.translation.z(), sunk + 20.0 * mm);
  EXPECT_GT(world.state(0).X_WO.translation.z(), middle.z() + 1e-6) << "relieved, it rises";
  run(2500);
  EXPECT_EQ(world.work().sleeping, 2U) << "the sponge again, not what is held";
}

TEST(SoftRest, EndsInTheStepInWhichTheGroundMoves) {
  constexpr double kStart = 2.5;
  const Vector3 aside(20.0 * mm, 0.0, 0.0);
  Play play(
      {lying_sponge(), ground({ground_at(0.0, Vector3::Zero()), ground_at(kStart, Vector3::Zero()),
                               ground_at(kStart + 1.0, aside), ground_at(20.0, aside)})});
  play.run(kStart);
  ASSERT_EQ(play.world().work().sleeping, 1U);
  const double before = play.state(0).X_WO.translation.x();
  play.step();
  EXPECT_EQ(play.world().work().sleeping, 0U);
  play.run(1.2);
  EXPECT_NEAR(play.state(0).X_WO.translation.x(), before + aside.x(), 50e-6) << "taken along";
  EXPECT_EQ(play.unconverged(), 0);
}

TEST(SoftRest, EndsByABlowThatLosesNoMomentum) {
  constexpr double kMass = 0.005;
  VirtualObject ball = loose("ball", Ball{6.0 * mm}, Vector3(0.3, 0.0, 0.0), kMass);
  ball.dynamics->velocity_W = Vector3(-0.2, 0.0, 0.0);
  Play play({sponge(Vector3::Zero()), ball}, Vector3::Zero());
  play.run(1.0);
  ASSERT_EQ(play.world().work().sleeping, 1U);
  play.run(1.0);
  EXPECT_EQ(play.world().work().sleeping, 0U);
  const double sponge_mass = 200.0 * kSponge.prod();
  EXPECT_LT(play.state(0).velocity.x(), -0.02);
  const Vector3 momentum = kMass * play.state(1).velocity + sponge_mass * play.state(0).velocity;
  EXPECT_LT((momentum - Vector3(-0.2 * kMass, 0.0, 0.0)).norm(), 1e-4 * 0.2 * kMass);
}

TEST(SoftRest, ComesToAllThatLieNearEachOther) {
  // Nearer than what wakes, further than what touches, and one falls later; the third apart.
  const Vector3 higher(kSponge.x() + 6.0 * mm, 0.0, kSponge.z() + 15.0 * mm);
  Play play({lying_sponge(), sponge(higher), lying_sponge(0.2), ground()});
  play.run(4.0);
  EXPECT_EQ(play.world().work().sleeping, 3U);
}

TEST(SoftRest, AndWakingAreTheSameOnAnyNumberOfThreads) {
  const auto scene = [](ThreadTeam* team) {
    const auto path = [](double time) {
      return Pose{Matrix3::Identity(),
                  Vector3(0.0, 0.0, kTop + kPad + 20.0 * mm - 22.0 * mm * smooth(time, 2.5, 2.9))};
    };
    return Play(
        {lying_sponge(), lying_sponge(0.2), ground(), little_cube(Vector3(0, 0, kTop + 5.0 * mm))},
        kDown, {path}, team);
  };
  ThreadTeam team(2);
  Play alone = scene(nullptr);
  Play shared = scene(&team);
  const std::vector<std::size_t> sleeping = sleeping_in_both(alone, shared, 3.0);
  ASSERT_GE(sleeping.size(), 3U) << "fell asleep, and was woken";
  EXPECT_EQ(sleeping.back(), 1U) << "the sponge apart sleeps on";
}

}  // namespace
}  // namespace softfinger
