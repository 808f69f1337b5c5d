// What is at rest sleeps: it costs nothing, stays where it is, and wakes when anything comes of it.
#include "softfinger/world/body_rest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "play.hpp"
#include "sleeping_in_both.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

constexpr double kHalf = 10.0 * mm;

VirtualObject cube(const Vector3& at, double friction = 0.5) {
  return loose("cube", RoundedBox{Vector3::Constant(kHalf), 0.5 * mm}, at, 0.02, friction);
}

VirtualObject table(const std::vector<Waypoint>& waypoints) {
  VirtualObject object = still("table", RoundedBox{Vector3(200, 200, 10) * mm, 1.0 * mm});
  object.motion = Trajectory(waypoints);
  return object;
}

Waypoint place(double time, const Vector3& at) { return {time, {Matrix3::Identity(), at}}; }

/// Three cubes on each other on a table, whose top is at its centre's height and 10 mm.
std::vector<VirtualObject> tower_on(const VirtualObject& support) {
  std::vector<VirtualObject> objects{support};
  for (int i = 0; i < 3; ++i) {
    objects.push_back(cube(Vector3(0.3 * mm * i, 0.0, 10.0 * mm + (2 * i + 1) * kHalf)));
  }
  return objects;
}

const VirtualObject kStill = table({place(0.0, Vector3::Zero())});

TEST(BodyRest, AtRestForHalfASecondCostsNothingAndStays) {
  Play tower(tower_on(kStill));
  tower.run(0.4);
  EXPECT_EQ(tower.world().work().sleeping, 0U) << "not before its time";
  EXPECT_GT(tower.world().work().evaluations, 0);
  tower.run(0.6);
  const Pose before = tower.state(3).X_WO;
  const std::uint64_t hash = tower.world().state_hash();
  for (int k = 0; k < 2000; ++k) {
    tower.step();
    ASSERT_EQ(tower.world().work().sleeping, 3U);
    ASSERT_EQ(tower.world().work().islands, 0U);
    ASSERT_EQ(tower.world().work().evaluations, 0);
    ASSERT_EQ(tower.world().work().near, 0U);
    ASSERT_EQ(tower.world().summary().iterations, 0);
  }
  EXPECT_EQ(tower.state(3).X_WO.translation, before.translation);
  EXPECT_EQ(tower.state(3).velocity, Vector3::Zero());
  EXPECT_EQ(tower.world().state_hash(), hash);
  EXPECT_TRUE(tower.events().empty()) << "what it stands on has not let it go";
}

TEST(BodyRest, MovesOnWhileItIsSlow) {
  // A slider that friction of its oil brakes: 5 um/s are not at rest.
  VirtualObject drawer = cube(Vector3::Zero());
  drawer.dynamics->joint.emplace().kind = JointKind::kSlider;
  drawer.dynamics->joint->axis_O = Vector3::UnitX();
  drawer.dynamics->joint->spring = 1.0;
  drawer.dynamics->joint->rest = 1.0 * mm;
  drawer.dynamics->joint->damping = 200.0;
  Play slow({drawer});
  slow.run(2.0);
  EXPECT_EQ(slow.world().work().sleeping, 0U);
  EXPECT_NEAR(slow.state(0).joint, 1.0 * mm * (1.0 - std::exp(-2.0 / 200.0)), 0.02e-6);
}

TEST(BodyRest, EndsInTheStepInWhichTheTableMoves) {
  // The table falls faster than anything on it.
  constexpr double kStart = 1.5;
  Play tower(tower_on(table({place(0.0, Vector3::Zero()), place(kStart, Vector3::Zero()),
                             place(kStart + 0.02, Vector3(0, 0, -50.0 * mm)),
                             place(9.0, Vector3(0, 0, -50.0 * mm))})));
  tower.run(kStart);
  ASSERT_EQ(tower.world().work().sleeping, 3U);
  const double height = tower.state(3).X_WO.translation.z();
  tower.step();
  EXPECT_EQ(tower.world().work().sleeping, 0U);
  tower.run(0.049);
  const double fall = 0.5 * kGravity * 0.05 * 0.05;
  EXPECT_NEAR(tower.state(3).X_WO.translation.z(), height - fall, 0.06 * fall);
  tower.run(2.0);
  EXPECT_EQ(tower.world().work().sleeping, 3U) << "and sleeps again";
}

TEST(BodyRest, IsTakenAlongByTheTable) {
  Play tower(tower_on(
      table({place(0.0, Vector3::Zero()), place(1.5, Vector3::Zero()),
             place(3.5, Vector3(100.0 * mm, 0, 0)), place(9.0, Vector3(100.0 * mm, 0, 0))})));
  tower.run(1.5);
  ASSERT_EQ(tower.world().work().sleeping, 3U);
  tower.run(3.0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(tower.state(static_cast<std::size_t>(i + 1)).X_WO.translation.x(),
                100.0 * mm + 0.3 * mm * i, 20e-6);
  }
  EXPECT_EQ(tower.unconverged(), 0);
  for (const WorldEvent& event : tower.events()) EXPECT_NE(event.kind, EventKind::kImpact);
}

TEST(BodyRest, EndsBeforeAFingerTouches) {
  const auto push = [](double time) {
    // From the side against the upper cube, fast.
    const double x = -40.0 * mm + 40.0 * mm * smooth(time, 1.4, 1.6);
    return Pose{exp_rotation(Vector3(0.0, -0.5 * std::numbers::pi, 0.0)),
                Vector3(x - kHalf - kPad + 8.0 * mm, 0.0, 60.0 * mm)};
  };
  Play tower(tower_on(kStill), kDown, {push});
  tower.run(1.4);
  ASSERT_EQ(tower.world().work().sleeping, 3U);
  double first_force = 0.0;
  for (int k = 0; k < 600; ++k) {
    tower.step();
    const double force = tower.finger(0).contact().normal_force;
    if (!(force > 0.0)) continue;
    EXPECT_EQ(tower.world().work().sleeping, 0U) << tower.time();
    if (first_force == 0.0) first_force = force;
  }
  EXPECT_GT(first_force, 0.0);
  EXPECT_LT(first_force, 0.2) << "as of what can move";
  EXPECT_LT(tower.state(3).X_WO.translation.z(), 50.0 * mm) << "it has fallen";
}

TEST(BodyRest, ABlowLosesNoMomentum) {
  VirtualObject ball = loose("ball", Ball{8.0 * mm}, Vector3(-0.8, 2.0 * mm, 0.0), 0.03);
  ball.dynamics->velocity_W = Vector3(0.5, 0.0, 0.0);
  std::vector<VirtualObject> objects{cube(Vector3::Zero()), ball};
  Play play(objects, Vector3::Zero());
  play.run(1.0);
  ASSERT_EQ(play.world().work().sleeping, 1U);
  const Vector3 before = 0.03 * play.state(1).velocity;
  play.run(1.5);
  EXPECT_EQ(play.world().work().sleeping, 0U);
  EXPECT_GT(play.state(0).velocity.x(), 0.1);
  const Vector3 after = 0.03 * play.state(1).velocity + 0.02 * play.state(0).velocity;
  EXPECT_LT((after - before).norm(), 1e-9 * before.norm());
}

TEST(BodyRest, EndsForAllThatHangTogether) {
  // A row of cubes; someone takes the first.
  std::vector<VirtualObject> objects{kStill};
  for (int i = 0; i < 5; ++i) {
    objects.push_back(cube(Vector3((2.0 * kHalf + 0.2 * mm) * i, 0.0, 20.0 * mm)));
  }
  objects.push_back(cube(Vector3(0.15, 0.0, 20.0 * mm)));
  World world(objects, kDown, kStep);
  world.reset();
  int steps = 0;
  const auto run = [&](int count) {
    for (const int end = steps + count; steps < end;) {
      world.begin_step(kStep * ++steps);
      world.solve({}, {});
    }
  };
  run(1200);
  ASSERT_EQ(world.work().sleeping, 6U);
  const Pose X_WT{Matrix3::Identity(), Vector3(0.0, 0.0, 60.0 * mm)};
  world.hold(1, &X_WT);
  run(1);
  EXPECT_EQ(world.work().sleeping, 1U) << "the one that stands apart";
  run(300);
  EXPECT_GT(world.state(1).X_WO.translation.z(), 45.0 * mm);
  EXPECT_EQ(world.work().sleeping, 1U) << "what is held stays awake";
  world.hold(1, nullptr);
  run(200);
  EXPECT_LT(world.state(1).X_WO.translation.z(), 40.0 * mm) << "it falls again";
}

TEST(BodyRest, OfWhatHangsOnSomethingEndsWhenThatMoves) {
  VirtualObject frame = still("frame", Ball{2.0 * mm});
  frame.motion =
      Trajectory({place(0.0, Vector3::Zero()), place(1.5, Vector3::Zero()),
                  place(1.6, Vector3(20.0 * mm, 0, 0)), place(9.0, Vector3(20.0 * mm, 0, 0))});
  VirtualObject bob = cube(Vector3(0.0, 0.0, -0.1));
  bob.dynamics->joint.emplace().kind = JointKind::kHinge;
  bob.dynamics->joint->parent = 0;
  bob.dynamics->joint->axis_O = Vector3::UnitY();
  bob.dynamics->joint->point_O = Vector3(0.0, 0.0, 0.1);
  Play pendulum({frame, bob});
  pendulum.run(1.5);
  ASSERT_EQ(pendulum.world().work().sleeping, 1U);
  pendulum.step();
  EXPECT_EQ(pendulum.world().work().sleeping, 0U);
  double swing = 0.0;
  for (int k = 0; k < 1000; ++k) {
    pendulum.step();
    swing = std::max(swing, std::abs(pendulum.state(1).joint));
  }
  EXPECT_GT(swing, 0.05);
}

TEST(BodyRest, AndWakingAreTheSameOnAnyNumberOfThreads) {
  const auto scene = [](ThreadTeam* team) {
    std::vector<VirtualObject> objects = tower_on(kStill);
    VirtualObject ball = loose("ball", Ball{8.0 * mm}, Vector3(-0.19, 0.0, 18.0 * mm), 0.03);
    ball.dynamics->velocity_W = Vector3(0.05, 0.0, 0.0);
    ball.dynamics->angular_velocity_W = Vector3(0.0, 0.05 / (8.0 * mm), 0.0);
    objects.push_back(ball);
    objects.push_back(cube(Vector3(0.1, 0.1, 20.0 * mm)));
    return Play(objects, kDown, {}, team);
  };
  ThreadTeam team(2);
  Play alone = scene(nullptr);
  Play shared = scene(&team);
  const std::vector<std::size_t> sleeping = sleeping_in_both(alone, shared, 6.0);
  ASSERT_GE(sleeping.size(), 3U) << "fell asleep, and was woken";
  EXPECT_EQ(sleeping[1], 4U) << "all but the ball";
  EXPECT_EQ(sleeping[2], 1U) << "the tower is hit, the cube apart sleeps on";
}

/// Energy of cubes, J.
double energy_of(const Play& play, std::size_t first, std::size_t count) {
  double sum = 0.0;
  for (std::size_t o = first; o < first + count; ++o) {
    const ObjectState& state = play.state(o);
    const double moment = 0.02 * 4.0 * kHalf * kHalf / 6.0;
    sum += 0.5 * 0.02 * state.velocity.squaredNorm() +
           0.5 * moment * state.angular_velocity.squaredNorm() +
           0.02 * kGravity * state.X_WO.translation.z();
  }
  return sum;
}

TEST(BodyRest, GainsNoEnergyAsItBeginsAndEnds) {
  std::vector<VirtualObject> objects{still("ground", HalfSpace{}), cube(Vector3(0, 0, kHalf)),
                                     cube(Vector3(0, 0, 3.0 * kHalf)),
                                     cube(Vector3(0, 2.0 * mm, 1.0))};
  // The third comes down in 0.45 s; then once more, when all sleep, by a ball.
  Play play(objects);
  double least = energy_of(play, 1, 3);
  std::size_t most_sleeping = 0;
  for (int k = 0; k < 3000; ++k) {
    play.step();
    const double now = energy_of(play, 1, 3);
    EXPECT_LT(now - least, 3 * 0.02 * kGravity * 0.2e-6) << play.time();
    least = std::min(least, now);
    most_sleeping = std::max(most_sleeping, play.world().work().sleeping);
  }
  EXPECT_EQ(most_sleeping, 3U);
}

}  // namespace
}  // namespace softfinger
