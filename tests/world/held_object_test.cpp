// Soft fingers and the objects that they push, press and hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "play.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

TEST(PressedObject, ThatRestsFeelsLikeOneThatCannotMove) {
  const RoundedBox box{Vector3(20, 20, 10) * mm, 1.0 * mm};
  const auto press = [](double time) {
    return Pose{Matrix3::Identity(),
                Vector3(0.0, 0.0, kPad + 0.5 * mm - 2.5 * mm * smooth(time, 0.0, 0.25))};
  };
  const Vector3 at(0.0, 0.0, -10.0 * mm);
  Play fixed({still("box", box, at)}, kDown, {press});
  Play free({loose("box", box, at, 0.05), still("ground", HalfSpace{}, 2.0 * at)}, kDown, {press});
  fixed.run(0.3);
  free.run(0.3);
  const double wanted = fixed.finger(0).contact().normal_force;
  ASSERT_GT(wanted, 0.3);
  EXPECT_NEAR(free.finger(0).contact().normal_force, wanted, 2e-3 * wanted);
  EXPECT_LT(free.state(0).X_WO.translation.z(), at.z());
  EXPECT_GT(free.state(0).X_WO.translation.z(), at.z() - 2e-6);
  EXPECT_EQ(free.unconverged(), 0);
}

/// Two fingers on a cube of 30 mm that stands on the ground: pinch, lift, then as `moved` says.
Play pinched_cube(double mass, double depth, const std::function<Vector3(double)>& moved,
                  ThreadTeam* team = nullptr) {
  const RoundedBox cube{Vector3::Constant(15.0 * mm), 1.0 * mm};
  const auto side = [=](double sign) {
    return [=](double time) {
      const double x = 15.0 * mm + kPad + 0.5 * mm - (depth + 0.5 * mm) * smooth(time, 0.0, 0.3);
      const Vector3 lift(0.0, 0.0, 20.0 * mm * smooth(time, 0.35, 0.7));
      return Pose{exp_rotation(Vector3(0.0, sign * 0.5 * std::numbers::pi, 0.0)),
                  Vector3(sign * x, 0.0, 0.0) + lift + moved(time)};
    };
  };
  return Play({loose("cube", cube, Vector3::Zero(), mass),
               still("ground", HalfSpace{}, Vector3(0.0, 0.0, -15.0 * mm))},
              kDown, {side(1.0), side(-1.0)}, team);
}

Vector3 nowhere(double /*time*/) { return Vector3::Zero(); }

TEST(HeldObject, StaysHeld) {
  Play hands = pinched_cube(0.045, 2.0 * mm, nowhere);
  hands.run(1.0);
  const Pose settled = hands.state(0).X_WO;
  EXPECT_GT(settled.translation.z(), 15.0 * mm);  // lifted
  hands.run(1.0);
  const Vector3 drift = hands.state(0).X_WO.translation - settled.translation;
  EXPECT_LT(drift.norm(), 1e-6);
  EXPECT_GT(hands.finger(0).contact().normal_force, 0.5);
}

TEST(HeldObject, WithoutFrictionEnoughSlipsDown) {
  // 2 mu N is less than the weight.
  Play hands = pinched_cube(0.3, 2.0 * mm, nowhere);
  hands.run(1.0);
  EXPECT_LT(hands.state(0).X_WO.translation.z(), 1.0 * mm);
}

TEST(HeldObject, GivesTheSameBitsOnAnyNumberOfThreads) {
  ThreadTeam team(2);
  Play alone = pinched_cube(0.045, 2.0 * mm, nowhere);
  Play shared = pinched_cube(0.045, 2.0 * mm, nowhere, &team);
  for (int k = 0; k < 5; ++k) {
    alone.run(0.1);
    shared.run(0.1);
    EXPECT_EQ(alone.world().state_hash(), shared.world().state_hash()) << alone.time();
    EXPECT_EQ(alone.finger(1).state_hash(), shared.finger(1).state_hash()) << alone.time();
  }
}

}  // namespace
}  // namespace softfinger
