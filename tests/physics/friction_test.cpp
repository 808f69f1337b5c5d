// Coulomb friction of the shipped finger on every kind of object: press, then carry the object away
// sideways under the finger.

#include <gtest/gtest.h>

#include <algorithm>

#include "../support/folders.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"

namespace softfinger {
namespace {

constexpr double kFriction = 0.4;
constexpr double kPressed = 0.4;  // s
constexpr double kSpeed = 10e-3;  // m/s, along y
constexpr double kDrag = 0.5;     // s
constexpr double kPad = -7.2e-3;  // m, about where the pad ends below F

struct Case {
  std::string name;
  Shape shape;
  double top;  ///< height of the object above its origin, m
};

class FrictionOnEveryObject : public testing::TestWithParam<Case> {
 protected:
  /// The object at the end of the press and its way from there.
  std::vector<VirtualObject> object() const {
    const Vector3 at(0.0, 0.0, kPad - GetParam().top);
    const auto shifted = [&](double y) {
      return Pose{Matrix3::Identity(), at + Vector3(0.0, y, 0.0)};
    };
    Trajectory motion({{0.0, shifted(0.0)},
                       {kPressed, shifted(0.0)},
                       {kPressed + kDrag, shifted(kSpeed * kDrag)}});
    return {{"object", GetParam().shape, motion, kFriction}};
  }
  /// Calls visit(finger, time) after every step of press and drag.
  template <typename Visit>
  void explore(Visit&& visit) const {
    static const auto model = FingerModel::load(source_folder() + "/fingers/index.toml");
    const std::vector<VirtualObject> objects = object();
    FingerSimulation finger(model, objects, 1e-3);
    finger.reset({Matrix3::Identity(), Vector3(0.0, 0.0, 2e-3)});
    for (int k = 1; k * 1e-3 <= kPressed + kDrag; ++k) {
      const double time = k * 1e-3;
      const double down = 3.2e-3 * std::min(1.0, time / (0.75 * kPressed));
      const Pose X_WFt{Matrix3::Identity(), Vector3(0.0, 0.0, 2e-3 - down)};
      ASSERT_TRUE(finger.step(X_WFt, time).converged) << "at " << time << " s";
      visit(finger, time);
    }
  }
};

TEST_P(FrictionOnEveryObject, NeverExceedsCoulombsLimitAndReachesIt) {
  double greatest_ratio = 0.0;
  explore([&](const FingerSimulation& finger, double time) {
    for (const ContactSample& s : finger.contact().samples) {
      EXPECT_LE(s.tangential_force_F.norm(), s.friction_limit * 1.01 + 1e-5);
      EXPECT_NEAR(s.tangential_force_F.dot(s.normal_F), 0.0, 0.05 * s.friction_limit + 1e-9);
      if (s.in_contact && time > kPressed + 0.9 * kDrag) {
        EXPECT_NEAR(s.friction_limit, kFriction * s.normal_force, 0.05 * s.normal_force + 1e-4);
      }
    }
    greatest_ratio = std::max(greatest_ratio, finger.contact().slip_ratio);
  });
  EXPECT_GT(greatest_ratio, 0.9);
  EXPECT_LT(greatest_ratio, 1.01);
}

TEST_P(FrictionOnEveryObject, SlipBeginsWhereTheSkinIsPressedLeast) {
  std::vector<double> stuck;  // over the drag
  double stuck_pressure = 0.0;
  double sliding_pressure = 0.0;
  int frames = 0;
  explore([&](const FingerSimulation& finger, double time) {
    const ContactSet& contact = finger.contact();
    if (time < kPressed) return;
    stuck.push_back(contact.stuck_fraction);
    if (contact.stuck_fraction < 0.2 || contact.stuck_fraction > 0.8) return;
    double force[2] = {};
    int count[2] = {};
    for (const ContactSample& s : contact.samples) {
      if (!s.in_contact) continue;
      force[s.slides ? 1 : 0] += s.normal_force;
      ++count[s.slides ? 1 : 0];
    }
    stuck_pressure += force[0] / count[0];
    sliding_pressure += force[1] / count[1];
    ++frames;
  });
  EXPECT_GT(stuck.front(), 0.5);
  EXPECT_LT(*std::min_element(stuck.begin(), stuck.end()), 0.05);
  ASSERT_GT(frames, 3);
  EXPECT_GT(stuck_pressure, 1.3 * sliding_pressure);
}

INSTANTIATE_TEST_SUITE_P(
    Friction, FrictionOnEveryObject,
    testing::Values(Case{"plane", HalfSpace{}, 0.0}, Case{"sphere", Ball{20e-3}, 20e-3},
                    Case{"box", RoundedBox{Vector3(20e-3, 20e-3, 5e-3), 1e-3}, 5e-3},
                    Case{"cylinder", RoundedCylinder{15e-3, 4e-3, 1e-3}, 4e-3}),
    [](const auto& of) { return of.param.name; });

TEST(Friction, HoldsWithoutCreepThroughALongHold) {
  const auto model = FingerModel::load(source_folder() + "/fingers/index.toml");
  const Pose tilted{exp_rotation(Vector3(0.15, 0.0, 0.0)), Vector3(0.0, 0.0, kPad)};
  const std::vector<VirtualObject> objects{{"slope", HalfSpace{}, Trajectory(tilted), 0.8}};
  FingerSimulation finger(model, objects, 1e-3);
  finger.reset({Matrix3::Identity(), Vector3(0.0, 0.0, 3e-3)});
  Vector3 after_a_second = Vector3::Zero();
  for (int k = 1; k <= 5000; ++k) {
    const double down = 4.0e-3 * std::min(1.0, k / 400.0);
    ASSERT_TRUE(
        finger.step({Matrix3::Identity(), Vector3(0.0, 0.0, 3e-3 - down)}, k * 1e-3).converged);
    if (k == 2000) after_a_second = finger.bone_pose().translation;
  }
  EXPECT_GT(finger.contact().stuck_fraction, 0.5);
  EXPECT_GT(finger.contact().tangential_force, 5e-3);
  EXPECT_LT((finger.bone_pose().translation - after_a_second).norm(), 1e-8);
}

}  // namespace
}  // namespace softfinger
