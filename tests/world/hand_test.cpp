// Bones of a hand: pulled to where they are tracked, no harder than their limit, and what they
// touch and hold.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "../support/derivative_check.hpp"
#include "../support/folders.hpp"
#include "play.hpp"
#include "softfinger/world/body_pull.hpp"
#include "softfinger/world/solid_contact.hpp"

namespace softfinger {
namespace {

constexpr TaperedCapsule kPhalanx{9.5e-3, 8.5e-3, 20e-3};
constexpr double kLimit = 5.0;  // N

Following pulled(double limit = kLimit, int hand = 0) {
  return {.hand = hand,
          .stiffness = 2000.0,
          .damping = 12.0,
          .rotation_stiffness = 0.8,
          .rotation_damping = 5e-3,
          .force_limit = limit,
          .torque_limit = 0.02 * limit,
          .foundation = 1e7};
}

VirtualObject bone(const Pose& X_WO, double limit = kLimit, int hand = 0) {
  VirtualObject object = loose("bone", kPhalanx, Vector3::Zero(), 0.015);
  object.motion = Trajectory(X_WO);
  object.dynamics->following = pulled(limit, hand);
  return object;
}

Pose at(double x, double y, double z) { return {Matrix3::Identity(), Vector3(x, y, z)}; }

Vector6 gradient_of(const BodyPull::Value& value) {
  Vector6 gradient;
  gradient << value.by_origin, value.by_turn;
  return gradient;
}

TEST(BodyPull, GradientAndHessianAreDerivativesBelowAndBeyondTheLimit) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  const auto any = [&] { return Vector3(part(generator), part(generator), part(generator)); };
  for (int k = 0; k < 40; ++k) {
    // From well within the limits to well beyond them.
    const double size = std::pow(10.0, -4.5 + 0.08 * k);
    BodyPull pull(pulled(), {exp_rotation(any()), any()});
    const Pose X_WT{exp_rotation(any()), any()};
    pull.put(X_WT);
    const Pose X_WO{exp_rotation(100.0 * size * any()) * X_WT.rotation,
                    X_WT.translation + size * any()};
    pull.begin(kStep, X_WO);
    const auto moved = [&](const Eigen::VectorXd& by) {
      return Pose{exp_rotation(by.tail<3>()) * X_WO.rotation, X_WO.translation + by.head<3>()};
    };
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
    const Eigen::VectorXd steps = Eigen::VectorXd::Constant(6, 1e-7);
    const Vector6 gradient = gradient_of(pull.evaluate(X_WO));
    EXPECT_LT(derivative_error(
                  [&](const Eigen::VectorXd& by) {
                    return Eigen::VectorXd::Constant(1, pull.evaluate(moved(by)).energy);
                  },
                  zero, gradient.transpose(), steps, 1e-3),
              1e-4)
        << size;
    // The derivative of the moment has an antisymmetric part, for turns do not commute.
    const Eigen::MatrixXd hessian = pull.hessian(X_WO);
    const auto symmetric = [&](const Eigen::VectorXd& direction) {
      const auto along = [&](double t) {
        return gradient_of(pull.evaluate(moved(t * direction))).dot(direction);
      };
      return (along(1e-6) - along(-1e-6)) / 2e-6;
    };
    for (int trial = 0; trial < 5; ++trial) {
      Eigen::VectorXd direction(6);
      direction << any(), any();
      const double wanted = direction.dot(hessian * direction);
      EXPECT_NEAR(symmetric(direction), wanted, 1e-3 * std::abs(wanted) + 1e-3) << size;
    }
  }
}

/// A world of bones and objects whose bones are told where to be.
class HandPlay {
 public:
  explicit HandPlay(std::vector<VirtualObject> objects, const Vector3& gravity = kDown)
      : objects_(std::move(objects)), world_(objects_, gravity, kStep) {
    world_.reset();
  }
  void follow(std::size_t o, const Pose& X_WT) { world_.follow(o, &X_WT); }
  void leave(std::size_t o) { world_.follow(o, nullptr); }
  void step() {
    ++steps_;
    world_.begin_step(kStep * steps_);
    world_.solve({}, {});
    unconverged_ += world_.summary().converged ? 0 : 1;
  }
  [[nodiscard]] const ObjectState& state(std::size_t o) const { return world_.state(o); }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] int unconverged() const { return unconverged_; }

 private:
  std::vector<VirtualObject> objects_;
  World world_;
  int steps_ = 0;
  int unconverged_ = 0;
};

TEST(HandBone, GoesWhereItIsTrackedAndHasNoWeight) {
  HandPlay hand({bone(at(0.0, 0.0, 0.0))});
  for (int k = 0; k < 100; ++k) hand.step();
  EXPECT_LT(hand.state(0).X_WO.translation.norm(), 1e-12) << "nothing draws it away";
  const Pose X_WT{exp_rotation(Vector3(0.1, -0.2, 0.3)), Vector3(4e-3, -2e-3, 1e-3)};
  for (int k = 0; k < 400; ++k) {
    hand.follow(0, X_WT);
    hand.step();
  }
  EXPECT_LT((hand.state(0).X_WO.translation - X_WT.translation).norm(), 1e-8);
  EXPECT_LT((hand.state(0).X_WO.rotation - X_WT.rotation).norm(), 1e-6);
  // In even motion dampers keep it up: it lags by what its own inertia makes of starting.
  for (int k = 1; k <= 400; ++k) {
    hand.follow(0, X_WT * at(1e-4 * k, 0.0, 0.0));
    hand.step();
  }
  const Vector3 end = X_WT * Vector3(0.04, 0.0, 0.0);
  EXPECT_LT((hand.state(0).X_WO.translation - end).norm(), 1e-6);
  EXPECT_EQ(hand.unconverged(), 0);
}

TEST(HandBone, PressesNoHarderThanItsLimit) {
  // A block on a spring tells the force.
  for (const double deep : {2.5e-3, 60e-3}) {
    VirtualObject block =
        loose("block", RoundedBox{Vector3(20, 20, 5) * mm, 1.0 * mm}, Vector3(0, 0, -5) * mm, 0.05);
    block.dynamics->joint.emplace().kind = JointKind::kSlider;
    block.dynamics->joint->spring = 1000.0;
    block.dynamics->joint->damping = 5.0;
    HandPlay hand({bone(at(0.0, 0.0, 10e-3)), block}, Vector3::Zero());
    for (int k = 0; k <= 1500; ++k) {
      hand.follow(0, at(0.0, 0.0, 9e-3 - deep * smooth(k * kStep, 0.0, 0.5)));
      hand.step();
    }
    const double force = -1000.0 * hand.state(1).joint;
    if (deep > 10e-3) {
      EXPECT_NEAR(force, kLimit, 1e-3 * kLimit);
    } else {
      EXPECT_GT(force, 0.3);
      EXPECT_LT(force, 0.99 * kLimit);
    }
    EXPECT_EQ(hand.unconverged(), 0) << deep;
  }
}

TEST(HandBone, FleshGivesAsAnElasticFoundation) {
  // On a plate, all of its strip is pressed in alike: force = foundation x strip x depth.
  const TaperedCapsule even{9e-3, 9e-3, 20e-3};
  VirtualObject finger = bone(at(0.0, 0.0, 10e-3), 100.0);
  finger.shape = even;
  VirtualObject plate =
      loose("plate", RoundedBox{Vector3(60, 60, 5) * mm, 1.0 * mm}, Vector3(0, 0, -5) * mm, 0.05);
  plate.dynamics->joint.emplace().kind = JointKind::kSlider;
  plate.dynamics->joint->spring = 20e3;
  plate.dynamics->joint->damping = 20.0;
  HandPlay hand({finger, plate}, Vector3::Zero());
  for (int k = 0; k <= 1000; ++k) {
    hand.follow(0, at(0.0, 0.0, 9e-3 - 2e-3 * smooth(k * kStep, 0.0, 0.5)));
    hand.step();
  }
  const double force = -20e3 * hand.state(1).joint;
  const double depth = 9e-3 + hand.state(1).joint - hand.state(0).X_WO.translation.z();
  ASSERT_GT(depth, 0.3e-3);
  // Half a spacing goes beyond each end.
  const double strip = 2.0 * even.half_length * (1.0 + 1.0 / 8.0) * 9e-3;
  EXPECT_NEAR(force, 1e7 * strip * depth, 1e-3 * force);
}

/// Two bones of one hand with a block between them that they lift.
HandPlay held_block(int other_hand) {
  const Pose left{exp_rotation(Vector3(0.0, 0.0, 0.5 * 3.14159265)), Vector3(-26e-3, 0, 0)};
  return HandPlay(
      {bone(left, 20.0, 0), bone({left.rotation, -left.translation}, 20.0, other_hand),
       loose("block", RoundedBox{Vector3(15, 20, 15) * mm, 1.0 * mm}, Vector3::Zero(), 0.1, 0.6),
       still("ground", HalfSpace{}, Vector3(0.0, 0.0, -15e-3))});
}

TEST(HandBone, TwoHoldABlockThatDoesNotCreep) {
  HandPlay hand = held_block(0);
  const Pose start = hand.state(0).X_WO;
  const auto press = [&](double time) {
    const double in = 5e-3 * smooth(time, 0.0, 0.3);
    const Vector3 lift(0.0, 0.0, 20e-3 * smooth(time, 0.35, 0.7));
    hand.follow(0, {start.rotation, start.translation + Vector3(in, 0.0, 0.0) + lift});
    hand.follow(1, {start.rotation, -start.translation - Vector3(in, 0.0, 0.0) + lift});
    hand.step();
  };
  for (int k = 1; k <= 1000; ++k) press(k * kStep);
  const Vector3 settled = hand.state(2).X_WO.translation;
  EXPECT_GT(settled.z(), 15e-3) << "lifted";
  for (int k = 1001; k <= 2000; ++k) press(k * kStep);
  EXPECT_LT((hand.state(2).X_WO.translation - settled).norm(), 5e-6);
  EXPECT_EQ(hand.unconverged(), 0);
}

TEST(HandBone, OfOneHandDoNotTouchEachOtherAndOfTwoDo) {
  for (const int other : {0, 1}) {
    HandPlay hands({bone(at(0.0, 0.0, 0.0), 5.0, 0), bone(at(0.0, 30e-3, 0.0), 5.0, other)});
    for (int k = 0; k < 500; ++k) {
      hands.follow(1, at(0.0, 30e-3 - 20e-3 * smooth(k * kStep, 0.0, 0.3), 0.0));
      hands.step();
    }
    const double moved = std::abs(hands.state(0).X_WO.translation.y());
    if (other == 0) {
      EXPECT_LT(moved, 1e-9);
    } else {
      EXPECT_GT(moved, 0.3e-3);
    }
    EXPECT_EQ(hands.unconverged(), 0);
  }
}

TEST(HandBone, ThatNobodySeesIsNowhereAndOneThatAppearsInsideSomethingPartsSlowly) {
  HandPlay hand({bone(at(0.0, 0.0, 0.0), 20.0),
                 loose("ball", Ball{20e-3}, Vector3(0.0, 0.0, 20e-3), 0.03),
                 still("ground", HalfSpace{})});
  hand.leave(0);
  for (int k = 0; k < 100; ++k) {
    hand.leave(0);
    hand.step();
  }
  EXPECT_LT(hand.state(0).X_WO.translation.z(), -100.0);
  EXPECT_LT(std::abs(hand.state(1).X_WO.translation.z() - 20e-3), 2e-6) << "nothing touches it";
  double fastest = 0.0;
  for (int k = 0; k < 400; ++k) {
    hand.follow(0, at(0.0, 15e-3, 20e-3));
    hand.step();
    fastest = std::max(fastest, hand.state(1).velocity.norm());
  }
  EXPECT_LT((hand.state(0).X_WO.translation - Vector3(0.0, 15e-3, 20e-3)).norm(), 1e-3) << "there";
  EXPECT_GT(fastest, 1e-3) << "they part";
  EXPECT_LT(fastest, 0.12) << "slowly";
  EXPECT_EQ(hand.unconverged(), 0);
}

// In the middle nothing says which way is out; what it finds must not throw it.
TEST(HandBone, ThatAppearsInAnObjectsMiddlePartsSlowlyAndIsNamed) {
  const std::vector<Shape> shapes{Ball{20e-3}, RoundedBox{Vector3(20, 20, 20) * mm, 1.0 * mm},
                                  RoundedBox{Vector3(40, 40, 3) * mm, 1.0 * mm},
                                  RoundedCylinder{30e-3, 80e-3, 3e-3}};
  constexpr std::size_t kPlate = 2;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    for (const double off : {0.0, 1e-6, 2e-3}) {
      HandPlay hand({bone(at(0.0, 0.0, 0.0), 20.0),
                     loose("thing", shapes[s], at(0, 0, 0.1).translation, 0.1)},
                    Vector3::Zero());
      hand.leave(0);
      for (int k = 0; k < 10; ++k) hand.step();
      EXPECT_TRUE(hand.world().overlaps().empty());
      const Pose X_WT{exp_rotation(Vector3(0.3, 0.2, 0.1)), Vector3(off, 0.3 * off, 0.1)};
      double fastest = 0.0;
      for (int k = 0; k < 2000; ++k) {
        hand.follow(0, X_WT);
        hand.step();
        fastest = std::max(fastest, hand.state(1).velocity.norm());
      }
      EXPECT_LT(fastest, 4.0 * SolidContact::kParting) << s << " " << off;
      EXPECT_LE(hand.unconverged(), 4) << s << " " << off;
      ASSERT_EQ(hand.world().overlaps().size(), 1U);
      const Overlap& named = hand.world().overlaps().front();
      EXPECT_EQ(named.first, 0U);
      EXPECT_EQ(named.second, 1U);
      EXPECT_GT(named.depth, 5e-3);
      EXPECT_NEAR(named.time, 11.0 * kStep, 1e-9);
      if (s == kPlate) continue;  // put through it, it may stick there
      const ObjectState& thing = hand.state(1);
      const Pose X_OB = thing.X_WO.inverse() * hand.state(0).X_WO;
      for (const double end : {-1.0, 0.0, 1.0}) {
        const Vector3 place = X_OB * Vector3(end * kPhalanx.half_length, 0.0, 0.0);
        EXPECT_GT(distance_and_gradient(shapes[s], place).distance, 7e-3)
            << s << " " << off << " has parted";
      }
    }
  }
}

TEST(HandBone, IsMetByNoFingerOfItsOwnHand) {
  static const auto model =
      FingerModel::load(std::filesystem::path(source_folder()) / "fingers/index.toml");
  const Matrix3 upside_down = exp_rotation(Vector3(3.141592653589793, 0.0, 0.0));
  for (const int hand : {-1, 0}) {
    for (const double side : {1.0, -1.0}) {  // from above, from below
      const std::vector<VirtualObject> objects{bone(at(0.0, 0.0, 0.0))};
      World world(objects, kDown, kStep);
      FingerSimulation finger(model, objects, kStep, nullptr, hand);
      EXPECT_EQ(finger.may_touch(0), hand < 0);
      world.add(finger);
      const Vector3 outside(0.0, 0.0, side * (9e-3 + kPad + 0.3e-3));
      const Matrix3 turn = side > 0.0 ? Matrix3(Matrix3::Identity()) : upside_down;
      finger.reset({turn, outside});
      world.reset();
      const std::array<FingerSimulation*, 1> all{&finger};
      std::array<StepSummary, 1> summary;
      for (int k = 1; k <= 150; ++k) {
        world.begin_step(k * kStep);
        finger.begin_step({turn, outside - side * Vector3(0, 0, 1e-5 * k)}, k * kStep);
        world.solve(all, summary);
        finger.end_step();
        EXPECT_TRUE(summary[0].converged);
      }
      const double pushed = -side * world.state(0).X_WO.translation.z();
      if (hand == 0) {
        EXPECT_EQ(finger.contact().normal_force, 0.0);
        EXPECT_LT(std::abs(pushed), 1e-12);
      } else {
        EXPECT_GT(finger.contact().normal_force, 0.05);
        EXPECT_GT(pushed, 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace softfinger
