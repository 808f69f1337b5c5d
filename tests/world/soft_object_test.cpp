// Soft objects: resting, pressed, pushed and held by soft fingers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "soft_box.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

const Vector3 kSize = Vector3(30, 30, 20) * mm;
const std::array<int, 3> kCells{5, 5, 4};

/// Straight down by `depth` into a surface at z = 0, in 0.25 s.
Play::Path press(double depth) {
  return [depth](double time) {
    return Pose{Matrix3::Identity(),
                Vector3(0.0, 0.0, kPad + 0.5 * mm - (depth + 0.5 * mm) * smooth(time, 0.0, 0.25))};
  };
}

const Vector3 kBelow(0.0, 0.0, -10.0 * mm);

TEST(SoftObject, FallsAndRestsCompressedByItsWeight) {
  constexpr double kModulus = 20e3;
  constexpr double kDensity = 200.0;
  Play play({soft("sponge", soft_box(kSize, kCells, kModulus, 0.3, kDensity),
                  Vector3(0.0, 0.0, 15.0 * mm), 0.0),
             still("ground", HalfSpace{}, Vector3::Zero(), 0.0)});
  play.run(1.0);
  const double height = kSize.z();
  // A column that slides freely: stress rho g (H - z).
  const double sinks = kDensity * kGravity * height * height / (3.0 * kModulus);
  EXPECT_NEAR(play.state(0).X_WO.translation.z(), 0.5 * height - sinks, 0.1 * sinks);
  EXPECT_LT(play.state(0).velocity.norm(), 1e-5);
  EXPECT_EQ(play.unconverged(), 0);
  ASSERT_FALSE(play.events().empty());
  EXPECT_EQ(play.events().front().kind, EventKind::kImpact);
  const double way = 5.0 * mm;
  EXPECT_NEAR(play.events().front().time, std::sqrt(2.0 * way / kGravity), 2.0 * kStep);
}

TEST(SoftObject, EverStifferBecomesTheRigidResult) {
  const RoundedBox box{0.5 * kSize, 0.0};
  Play rigid({still("box", box, kBelow)}, kDown, {press(1.5 * mm)});
  rigid.run(0.3);
  const double wanted = rigid.finger(0).contact().normal_force;
  const double area = rigid.finger(0).contact().contact_area;
  ASSERT_GT(wanted, 0.3);
  double before = 1.0;
  for (const double modulus : {1e5, 1e6, 1e7, 1e8}) {
    Play play({soft("box", soft_box(kSize, kCells, modulus, 0.3, 1000.0, true), kBelow)}, kDown,
              {press(1.5 * mm)});
    play.run(0.3);
    const double error = (wanted - play.finger(0).contact().normal_force) / wanted;
    EXPECT_GT(error, -2e-3) << modulus;
    EXPECT_LT(error, before) << modulus;
    EXPECT_EQ(play.unconverged(), 0) << modulus;
    if (modulus >= 1e8) {
      EXPECT_LT(std::abs(error), 0.01);
      EXPECT_NEAR(play.finger(0).contact().contact_area, area, 0.05 * area);
    }
    before = error;
  }
}

// Cubes of 70 times its weight fall flat on it, straight and on an edge.
TEST(SoftObject, IsCrushedWithoutTurningInsideOut) {
  const Vector3 size = Vector3(30, 30, 20) * mm;
  for (const double turned : {0.0, 30.0 * deg}) {
    VirtualObject weight =
        loose("weight", RoundedBox{Vector3::Constant(15.0 * mm), 1.0 * mm}, Vector3::Zero(), 0.25);
    weight.motion = Trajectory(
        Pose{exp_rotation(Vector3(turned, 0.0, 0.0)), Vector3(4.0 * mm, 2.0 * mm, 45.0 * mm)});
    weight.dynamics->velocity_W = Vector3(0.0, 0.0, -1.5);
    Play play(
        {soft("sponge", soft_box(size, {3, 3, 2}, 10e3, 0.3, 200.0), Vector3(0.0, 0.0, 10.0 * mm)),
         still("ground", HalfSpace{}), weight});
    const TetrahedralMesh& mesh = play.objects()[0].soft->mesh;
    double flattest = 1.0;
    for (int k = 0; k < 300; ++k) {
      play.step();
      const auto nodes = play.world().nodes(0);
      for (const Tetrahedron& t : mesh.tetrahedra) {
        const auto volume = [&](const auto& at) {
          const Vector3 from = at[static_cast<std::size_t>(t[0])];
          return (at[static_cast<std::size_t>(t[1])] - from)
              .cross(at[static_cast<std::size_t>(t[2])] - from)
              .dot(at[static_cast<std::size_t>(t[3])] - from);
        };
        const double left = volume(nodes) / volume(mesh.nodes);
        flattest = std::min(flattest, left);
        ASSERT_GT(left, 0.0) << turned / deg << " degrees, step " << k;
      }
    }
    EXPECT_LT(flattest, 0.3) << "nothing crushed it";
    // Skin that is pressed around the weight's edge may stand where its side ends.
    EXPECT_LE(play.unconverged(), 3) << "of 300";
  }
}

TEST(SoftObject, SharesTheWayWithTheFinger) {
  // Both yield: under one force, the ways of finger and object add up.
  const auto pressed = [](double modulus, double depth) {
    Play play({soft("box", soft_box(kSize, kCells, modulus, 0.3, 200.0, true), kBelow)}, kDown,
              {press(depth)});
    play.run(0.3);
    return play.finger(0).contact().normal_force;
  };
  const double soft_force = pressed(20e3, 3.0 * mm);
  const double hard_force = pressed(1e8, 3.0 * mm);
  EXPECT_GT(soft_force, 0.05 * hard_force);
  EXPECT_LT(soft_force, 0.7 * hard_force);
}

TEST(SoftObject, GainsTheMomentumThatItIsPushedWith) {
  const auto solid = soft_box(kSize, kCells, 20e3, 0.3, 200.0);
  const double mass = 200.0 * kSize.prod();
  const auto push = [](double time) {
    return Pose{exp_rotation(Vector3(0.0, 0.5 * std::numbers::pi, 0.0)),
                Vector3(15.0 * mm + kPad + 0.2 * mm - 20.0 * mm * time, 0.0, 0.0)};
  };
  Play play({soft("sponge", solid, Vector3::Zero())}, Vector3::Zero(), {push});
  Vector3 impulse = Vector3::Zero();
  double greatest = 0.0;
  for (int k = 0; k < 200; ++k) {
    play.step();
    const ContactSet& contact = play.finger(0).contact();
    const Matrix3& R_WF = play.finger(0).bone_pose().rotation;
    const Vector3 normal = contact.normal_force * contact.mean_normal_F;
    impulse -= kStep * (R_WF * (normal + contact.tangential_force_F));
    greatest = std::max(greatest, contact.normal_force);
  }
  ASSERT_GT(greatest, 1e-3);
  const Vector3 momentum = mass * play.state(0).velocity;
  ASSERT_LT(momentum.x(), -0.01 * mass);
  EXPECT_LT((momentum - impulse).norm(), 1e-4 * impulse.norm());
  EXPECT_EQ(play.unconverged(), 0);
}

TEST(SoftObject, SpringsBackWhenAFingerIsSeenNoMore) {
  Play play({soft("sponge", soft_box(kSize, kCells, 20e3, 0.3, 200.0, true), kBelow)},
            Vector3::Zero(), {press(3.0 * mm)});
  const auto greatest_way = [&] {
    double greatest = 0.0;
    const std::vector<Vector3>& rest = play.objects()[0].soft->mesh.nodes;
    for (std::size_t n = 0; n < rest.size(); ++n) {
      greatest = std::max(greatest, (play.world().nodes(0)[n] - rest[n] - kBelow).norm());
    }
    return greatest;
  };
  play.run(0.3);
  EXPECT_GT(greatest_way(), 0.5 * mm);
  play.leave();
  play.run(0.3);
  EXPECT_LT(greatest_way(), 1e-6);
}

/// Two fingers lift a sponge of 30 mm off the ground.
Play held_sponge(ThreadTeam* team = nullptr) {
  const auto side = [=](double sign) {
    return [=](double time) {
      const double x = 15.0 * mm + kPad + 0.5 * mm - 3.5 * mm * smooth(time, 0.0, 0.2);
      const Vector3 lift(0.0, 0.0, 15.0 * mm * smooth(time, 0.25, 0.6));
      return Pose{exp_rotation(Vector3(0.0, sign * 0.5 * std::numbers::pi, 0.0)),
                  Vector3(sign * x, 0.0, 0.0) + lift};
    };
  };
  return Play({soft("sponge", soft_box(kSize, kCells, 20e3, 0.3, 200.0), Vector3::Zero()),
               still("ground", HalfSpace{}, kBelow)},
              kDown, {side(1.0), side(-1.0)}, team);
}

TEST(HeldSponge, IsLiftedAndDoesNotCreep) {
  Play play = held_sponge();
  play.run(1.0);
  const double lifted = play.state(0).X_WO.translation.z();
  EXPECT_GT(lifted, 13.0 * mm);
  for (const int f : {0, 1}) {
    EXPECT_GT(play.finger(static_cast<std::size_t>(f)).contact().normal_force, 0.1);
  }
  play.run(0.5);
  EXPECT_NEAR(play.state(0).X_WO.translation.z(), lifted, 1e-6);
}

TEST(HeldSponge, HasTheSameBitsOnAnyNumberOfThreads) {
  Play alone = held_sponge();
  alone.run(0.3);
  ThreadTeam team(2);
  Play together = held_sponge(&team);
  together.run(0.3);
  ASSERT_GT(alone.finger(0).contact().normal_force, 0.1);
  EXPECT_EQ(alone.world().state_hash(), together.world().state_hash());
}

}  // namespace
}  // namespace softfinger
