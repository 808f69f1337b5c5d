// Objects without fingers: against what Newton's laws say.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "play.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/geometry/mass_properties.hpp"
#include "softfinger/world/solid_contact.hpp"

namespace softfinger {
namespace {

RoundedBox cube(double size) { return {Vector3::Constant(0.5 * size), 0.5 * mm}; }

TEST(RigidMotion, FallsAsGravitySays) {
  Play play({loose("ball", Ball{10.0 * mm}, Vector3(0.0, 0.0, 2.0), 0.02)});
  play.run(0.5);
  EXPECT_NEAR(play.state(0).X_WO.translation.z(), 2.0 - 0.5 * kGravity * 0.25,
              0.5 * kGravity * 0.5 * kStep * 1.1);
  EXPECT_NEAR(play.state(0).velocity.z(), -kGravity * 0.5, 1e-3);
  EXPECT_EQ(play.unconverged(), 0);
}

TEST(RigidMotion, SpinOfAnUnevenBodyKeepsItsMomentum) {
  VirtualObject box =
      loose("box", RoundedBox{Vector3(30, 10, 4) * mm, 1.0 * mm}, Vector3::Zero(), 0.1);
  box.dynamics->angular_velocity_W = Vector3(3.0, 11.0, 0.5);
  Play play({box}, Vector3::Zero());
  const MassProperties even = *mass_properties(box.shape);
  const Matrix3 second = 0.1 / even.volume * even.second_moment_O;
  const Matrix3 inertia = second.trace() * Matrix3::Identity() - second;
  const auto momentum = [&] {
    const Matrix3& R = play.state(0).X_WO.rotation;
    return Vector3(R * inertia * R.transpose() * play.state(0).angular_velocity);
  };
  const auto energy = [&] { return 0.5 * momentum().dot(play.state(0).angular_velocity); };
  const Vector3 before = momentum();
  const double energy_before = energy();
  play.run(3.0);
  EXPECT_LT((momentum() - before).norm(), 1e-9 * before.norm());
  EXPECT_NEAR(energy(), energy_before, 2e-3 * energy_before);
  // It tumbles: the axis has turned.
  EXPECT_LT(play.state(0).angular_velocity.normalized().dot(Vector3(3.0, 11.0, 0.5).normalized()),
            0.999);
}

TEST(RigidMotion, RestsOnAPlaneWithinAMicrometre) {
  for (const double mass : {1e-3, 0.05, 2.0}) {
    Play play({still("ground", HalfSpace{}),
               loose("cube", cube(30.0 * mm), Vector3(0, 0, 16.0 * mm), mass)});
    play.run(0.5);
    EXPECT_NEAR(play.state(1).X_WO.translation.z(), 15.0 * mm, 1e-6) << mass;
    EXPECT_LT(play.state(1).X_WO.translation.z(), 15.0 * mm) << mass;
    const Pose settled = play.state(1).X_WO;
    play.run(1.0);
    EXPECT_LT((play.state(1).X_WO.translation - settled.translation).norm(), 1e-8) << mass;
    EXPECT_EQ(play.unconverged(), 0) << mass;
  }
}

TEST(RigidMotion, SticksOnAnInclineUpToTheAngleOfFriction) {
  const double mu = 0.4;
  const double critical = std::atan(mu);
  for (const double off : {-0.3 * deg, 0.3 * deg}) {
    const double angle = critical + off;
    const Vector3 along(std::cos(angle), 0.0, -std::sin(angle));
    const Vector3 gravity = kGravity * Vector3(std::sin(angle), 0.0, -std::cos(angle));
    Play play({still("ground", HalfSpace{}, Vector3::Zero(), mu),
               loose("cube", RoundedBox{Vector3(20, 20, 5) * mm, 0.5 * mm}, Vector3(0, 0, 5.0 * mm),
                     0.05, mu)},
              gravity);
    play.run(0.5);
    const double start = play.state(1).X_WO.translation.x();
    const double speed = play.state(1).velocity.x();
    play.run(1.0);
    const double way = play.state(1).X_WO.translation.x() - start;
    if (off < 0.0) {
      EXPECT_LT(std::abs(way), 1e-6) << angle / deg;
    } else {
      const double wanted = kGravity * (std::sin(angle) - mu * std::cos(angle));
      const double got = play.state(1).velocity.x() - speed;
      EXPECT_NEAR(got, wanted, 0.01 * wanted);
      EXPECT_GT(way, 1e-3);
    }
  }
}

// As fast as its rim's points pass in a step: on a polygon it would gain energy.
TEST(RigidMotion, ACylinderRollsOnWithoutGainOrBumps) {
  const double radius = 16.0 * mm;
  const double mass = 0.05;
  for (const double spin : {1.0, 6.0, 20.0, 42.0, 52.3, 75.0}) {
    VirtualObject cylinder = loose("cylinder", RoundedCylinder{radius, 20.0 * mm, 1.0 * mm},
                                   Vector3(0.0, 0.0, radius), mass);
    cylinder.motion = Trajectory(
        Pose{exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0)), Vector3(0.0, 0.0, radius)});
    cylinder.dynamics->angular_velocity_W = Vector3(0.0, spin, 0.0);
    cylinder.dynamics->velocity_W = Vector3(spin * radius, 0.0, 0.0);
    Play play({still("ground", HalfSpace{}), cylinder});
    play.run(0.05);
    const double speed = play.state(1).velocity.x();
    EXPECT_NEAR(speed, spin * radius, 0.02 * spin * radius) << spin;
    double highest = 0.0;
    double lowest = radius;
    for (int k = 0; k < 2000; ++k) {
      play.step();
      highest = std::max(highest, play.state(1).X_WO.translation.z());
      lowest = std::min(lowest, play.state(1).X_WO.translation.z());
      EXPECT_LT(play.state(1).velocity.x(), speed * (1.0 + 1e-4)) << spin << " at " << k;
    }
    EXPECT_GT(play.state(1).velocity.x(), 0.95 * speed) << spin;
    EXPECT_LT(highest, radius + 0.5e-6) << spin;
    EXPECT_GT(lowest, radius - 2e-6) << spin;
    EXPECT_EQ(play.unconverged(), 0) << spin;
  }
}

// Friction that bends its way does no work, to either side.
TEST(RigidMotion, ARimThatRollsInACircleGainsNothing) {
  const double radius = 17.0 * mm;
  const double half_length = 6.0 * mm;
  const double round = 1.0 * mm;
  const double mass = 2e-3;
  const double lean = 58.0 * deg;  // of its axis, from the vertical
  const Vector3 axis(0.0, std::sin(lean), std::cos(lean));
  const Vector3 down(0.0, std::cos(lean), -std::sin(lean));  // along its end, to the lowest place
  const Vector3 contact =
      (radius - round) * down - (half_length - round) * axis - round * Vector3::UnitZ();
  for (const double side : {-1.0, 1.0}) {
    VirtualObject cylinder = loose("cylinder", RoundedCylinder{radius, half_length, round},
                                   Vector3(0.0, 0.0, -contact.z()), mass, 1.0);
    cylinder.motion =
        Trajectory(Pose{exp_rotation(Vector3(-lean, 0.0, 0.0)), Vector3(0.0, 0.0, -contact.z())});
    const Vector3 spin = side * Vector3(0.0, 70.0, 44.0);
    cylinder.dynamics->angular_velocity_W = spin;
    cylinder.dynamics->velocity_W = -spin.cross(contact);
    Play play({still("ground", HalfSpace{}, Vector3::Zero(), 1.0), cylinder});
    const MassProperties even = *mass_properties(cylinder.shape);
    const Matrix3 second = mass / even.volume * even.second_moment_O;
    const Matrix3 inertia = second.trace() * Matrix3::Identity() - second;
    const auto energy = [&] {
      const ObjectState& s = play.state(1);
      const Vector3 w = s.X_WO.rotation.transpose() * s.angular_velocity;
      return 0.5 * mass * s.velocity.squaredNorm() + 0.5 * w.dot(inertia * w) +
             mass * kGravity * s.X_WO.translation.z();
    };
    play.run(0.05);
    const double before = energy();
    const Vector3 heading = play.state(1).velocity.normalized();
    double turned = 0.0;
    double rolled = 0.0;
    for (int k = 0; k < 500; ++k) {
      play.step();
      EXPECT_LT(energy(), (1.0 + 1e-5) * before) << side << " at " << k;
      turned = std::max(turned, std::acos(play.state(1).velocity.normalized().dot(heading)));
      rolled += kStep * play.state(1).velocity.norm();
    }
    EXPECT_GT(energy(), 0.998 * before) << side;
    EXPECT_GT(turned, 20.0 * deg) << "it went straight on";
    EXPECT_GT(rolled, 0.3);
    EXPECT_EQ(play.unconverged(), 0);
  }
}

// Its rims' points may be on either side of a ball, whose own point bears it then.
TEST(RigidMotion, ACylinderRestsOnBallsHoweverItIsTurned) {
  const double radius = 16.0 * mm;
  const double ball = 6.0 * mm;
  std::vector<VirtualObject> objects;
  for (const double side : {-0.5, 0.5}) {
    for (const double end : {-19.0 * mm, 19.0 * mm}) {
      objects.push_back(
          still("ball", Ball{ball},
                Vector3((radius + ball) * std::sin(side), end, -(radius + ball) * std::cos(side))));
    }
  }
  for (int turned = 0; turned <= 6; ++turned) {
    VirtualObject cylinder =
        loose("cylinder", RoundedCylinder{radius, 20.0 * mm, 1.0 * mm}, Vector3::Zero(), 0.05);
    cylinder.motion = Trajectory(Pose{exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0)) *
                                          exp_rotation(Vector3(0.0, 0.0, 0.5 * turned * deg)),
                                      Vector3(0.0, 0.0, 0.0)});
    objects.push_back(cylinder);
    Play play(objects);
    play.run(0.5);
    EXPECT_LT(play.state(4).X_WO.translation.z(), 0.0) << turned;
    EXPECT_GT(play.state(4).X_WO.translation.z(), -2e-6) << turned;
    EXPECT_LT(play.state(4).velocity.norm(), 1e-6) << turned;
    EXPECT_EQ(play.unconverged(), 0) << turned;
    objects.pop_back();
  }
}

// Whatever is between them: contact is as stiff as the heaviest object wants.
TEST(RigidMotion, AHeavyObjectDoesNotPressALightOneIntoTheTable) {
  Play play({still("table", HalfSpace{}),
             loose("ball", Ball{10.0 * mm}, Vector3(0.0, 0.0, 10.0 * mm), 2e-3),
             loose("weight", cube(30.0 * mm), Vector3(0.0, 0.0, 60.0 * mm), 0.5)});
  double lowest = 0.0;
  for (int k = 0; k < 1000; ++k) {
    play.step();
    lowest = std::min(lowest, play.state(1).X_WO.translation.z() - 10.0 * mm);
  }
  EXPECT_GT(lowest, -0.2 * mm);
  EXPECT_LT(lowest, -1e-6) << "nothing has fallen on it";
}

// What falls on its side rolls it by many of its rims' points in one step.
TEST(RigidMotion, ABlowThatRollsACylinderDoesNotPressItIntoTheTable) {
  for (const double radius : {4.0 * mm, 8.0 * mm, 30.0 * mm}) {
    double most_turned = 0.0;  // m, of the rim in a step
    for (const double aside : {-0.9, -0.6, -0.4, 0.4, 0.6, 0.9}) {
      VirtualObject cylinder = loose("cylinder", RoundedCylinder{radius, 10.0 * mm, 1.0 * mm},
                                     Vector3(0.0, 0.0, radius), 1e-3, 1.0);
      cylinder.motion = Trajectory(
          Pose{exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0)), Vector3(0.0, 0.0, radius)});
      VirtualObject ball = loose("ball", Ball{12.0 * mm},
                                 Vector3(aside * radius, 0.0, 2.0 * radius + 19.0 * mm), 0.1, 1.0);
      ball.dynamics->velocity_W = Vector3(0.0, 0.0, -2.3);
      Play play({still("table", HalfSpace{}, Vector3::Zero(), 1.0), cylinder, ball});
      double lowest = radius;
      for (int k = 0; k < 100; ++k) {
        play.step();
        lowest = std::min(lowest, play.state(1).X_WO.translation.z());
        most_turned = std::max(most_turned, radius * kStep * play.state(1).angular_velocity.norm());
      }
      EXPECT_GT(lowest, radius - 0.1 * mm) << radius / mm << " mm, aside by " << aside;
    }
    EXPECT_GT(most_turned, 0.5 * mm) << radius / mm << " mm: nothing rolled it far in a step";
  }
}

TEST(RigidMotion, MomentumIsKeptInACollision) {
  VirtualObject a = loose("a", Ball{8.0 * mm}, Vector3(-20.0 * mm, 0.0, 0.0), 0.03);
  a.dynamics->velocity_W = Vector3(0.5, 0.02, 0.0);
  Play play({a, loose("b", cube(20.0 * mm), Vector3(10.0 * mm, 5.0 * mm, 2.0 * mm), 0.05)},
            Vector3::Zero());
  const auto momentum = [&] {
    return Vector3(0.03 * play.state(0).velocity + 0.05 * play.state(1).velocity);
  };
  const auto about = [&](std::size_t o, double mass) {
    const VirtualObject& object = play.objects()[o];
    const MassProperties even = *mass_properties(object.shape);
    const Matrix3 second = mass / even.volume * even.second_moment_O;
    const Matrix3 inertia = second.trace() * Matrix3::Identity() - second;
    const ObjectState& s = play.state(o);
    return Vector3(s.X_WO.rotation * inertia * s.X_WO.rotation.transpose() * s.angular_velocity +
                   mass * s.X_WO.translation.cross(s.velocity));
  };
  const Vector3 before = momentum();
  const Vector3 angular_before = about(0, 0.03) + about(1, 0.05);
  play.run(0.2);
  EXPECT_GT(play.state(1).velocity.norm(), 0.05);  // it was hit
  EXPECT_LT((momentum() - before).norm(), 1e-9 * before.norm());
  // To first order in the step: a blow is given where the ball is at the step's end.
  const double impulse = 0.05 * play.state(1).velocity.norm();
  EXPECT_LT((about(0, 0.03) + about(1, 0.05) - angular_before).norm(), 0.5 * kStep * 0.5 * impulse);
}

TEST(RigidMotion, BlowsArePlasticFromAnyHeight) {
  for (const double height : {2.0, 5.0, 10.0, 37.0, 120.0}) {
    Play play({still("ground", HalfSpace{}),
               loose("ball", Ball{5.0 * mm}, Vector3(0.0, 0.0, (5.0 + height) * mm), 3e-3)});
    const auto landing = static_cast<int>(std::sqrt(2.0 * height * mm / kGravity) / kStep);
    for (int k = 0; k < landing + 5; ++k) play.step();
    for (int k = 0; k < 100; ++k) {
      play.step();
      EXPECT_LT(play.state(1).X_WO.translation.z(), 5.001 * mm) << height;
    }
  }
}

TEST(RigidMotion, WhatStartsInsideAnotherPartsSlowlyAndIsNamed) {
  Play play({still("ground", HalfSpace{}),
             loose("low", cube(30.0 * mm), Vector3(0.0, 0.0, 12.0 * mm), 0.05),
             loose("high", cube(30.0 * mm), Vector3(1.0 * mm, 2.0 * mm, 38.0 * mm), 0.05)});
  ASSERT_EQ(play.world().overlaps().size(), 2U);
  EXPECT_EQ(play.world().overlaps()[0].second, 1U);
  EXPECT_NEAR(play.world().overlaps()[0].depth, 3.0 * mm, 1e-9);
  EXPECT_EQ(play.world().overlaps()[1].first, 1U);
  EXPECT_NEAR(play.world().overlaps()[1].depth, 4.0 * mm, 0.1 * mm);
  for (int k = 0; k < 400; ++k) {
    play.step();
    // The upper one rides on the lower.
    EXPECT_LT(play.state(1).velocity.norm(), 1.25 * SolidContact::kParting) << k;
    EXPECT_LT(play.state(2).velocity.norm(), 2.5 * SolidContact::kParting) << k;
  }
  EXPECT_NEAR(play.state(1).X_WO.translation.z(), 15.0 * mm, 1e-6);
  EXPECT_NEAR(play.state(2).X_WO.translation.z(), 45.0 * mm, 1e-6);
}

TEST(RigidMotion, APendulumKeepsSwinging) {
  // A rod that is mostly its bob: 1 Hz.
  VirtualObject bob = loose("bob", Ball{5.0 * mm}, Vector3::Zero(), 0.05);
  const double length = kGravity / std::pow(2.0 * std::numbers::pi, 2);
  Joint hinge{
      .kind = JointKind::kHinge, .axis_O = Vector3::UnitY(), .point_O = Vector3(0.0, 0.0, length)};
  bob.dynamics->joint = hinge;
  bob.dynamics->angular_velocity_W = Vector3(0.0, 0.5, 0.0);
  Play play({bob});
  const auto greatest = [&](double duration) {
    double most = 0.0;
    for (int k = 0; k < static_cast<int>(duration / kStep); ++k) {
      play.step();
      most = std::max(most, std::abs(play.state(0).joint));
    }
    return most;
  };
  const double first = greatest(1.1);
  play.run(8.0);
  const double later = greatest(1.1);
  EXPECT_NEAR(first, 0.5 / (2.0 * std::numbers::pi), 2e-3);
  EXPECT_NEAR(later, first, 1e-3 * first);
  EXPECT_EQ(play.unconverged(), 0);
}

}  // namespace
}  // namespace softfinger
