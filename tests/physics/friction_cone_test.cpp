#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "project.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger {
namespace {

constexpr double kConeStep = 1e-3;

VirtualObject object(Shape shape, const Pose& pose, double friction) {
  VirtualObject object;
  object.shape = std::move(shape);
  object.motion = Trajectory(std::vector<Waypoint>{{0.0, pose}});
  object.friction_coefficient = friction;
  return object;
}

Pose at(double x, double y, double z) {
  return {Matrix3::Identity(), Vector3(x * mm, y * mm, z * mm)};
}

std::shared_ptr<const FingerModel> finger_on_cones() {
  static const auto model = FingerModel::load(kProject / "fingers/index.toml");
  return model;
}

// Friction is within the cone of the forces reported with it, in every step: landing, sliding, and
// most of all when the finger is lifted while it slides.
TEST(FrictionCone, HoldsInEveryStepOfATapThatSlides) {
  for (const double mu : {0.2, 0.5, 1.0}) {
    for (const Shape& shape : {Shape(HalfSpace{}), Shape(Ball{20.0 * mm})}) {
      const bool flat = std::holds_alternative<HalfSpace>(shape);
      const VirtualObject thing = object(shape, at(0, 0, flat ? 0.0 : -20.0), mu);
      FingerSimulation simulation(finger_on_cones(), {&thing, 1}, kConeStep);
      simulation.reset(at(0, 0, 9.0));
      double most_slip = 0.0;
      double most_force = 0.0;
      for (int k = 1; k <= 120; ++k) {
        const double part = k / 50.0;
        const double z = 9.0 - 3.0 * std::sin(std::min(1.0, 0.5 * part) * std::numbers::pi);
        const StepSummary step = simulation.step(at(4.0 * part, 0, z), k * kConeStep);
        EXPECT_TRUE(step.converged) << k;
        const ContactSet& contact = simulation.contact();
        const double cone = mu * contact.normal_force_sum;
        EXPECT_LE(contact.tangential_force, 1.01 * cone + 1e-4) << "step " << k << ", mu " << mu;
        EXPECT_LE(contact.normal_force, (1.0 + 1e-12) * contact.normal_force_sum);
        if (contact.normal_force_sum == 0.0) {
          EXPECT_LT(contact.tangential_force, 1e-9) << k;
        } else {
          EXPECT_NEAR(contact.slip_ratio * cone, contact.tangential_force, 1e-9 + 1e-6 * cone);
        }
        most_slip = std::max(most_slip, contact.slip_ratio);
        most_force = std::max(most_force, contact.normal_force);
      }
      EXPECT_GT(most_slip, 0.9) << mu;
      EXPECT_GT(most_force, 0.1) << mu;
    }
  }
}

// In a groove the sides push against each other; the finger feels what is left.
TEST(NormalForce, IsTheMagnitudeOfTheVectorSum) {
  std::vector<VirtualObject> sides;
  for (const double angle : {45.0, -45.0}) {
    Pose pose;
    pose.rotation = exp_rotation(Vector3(angle * deg, 0.0, 0.0));
    sides.push_back(object(HalfSpace{}, pose, 0.0));
  }
  FingerSimulation simulation(finger_on_cones(), sides, kConeStep);
  const Pose pose = at(0, 0, 9.5);
  simulation.reset(at(0, 0, 12.5));
  for (int k = 1; k <= 400; ++k) {
    simulation.step(at(0, 0, std::max(9.5, 12.5 - 0.03 * k)), k * kConeStep);
  }
  const Vector3 pull = finger_on_cones()->coupling.translation_stiffness *
                       (simulation.bone_pose().translation - pose.translation);
  const ContactSet& contact = simulation.contact();
  EXPECT_GT(contact.normal_force, 0.1);
  EXPECT_NEAR(contact.normal_force, pull.norm(), 2e-3 * pull.norm());
  EXPECT_GT(contact.normal_force_sum, 1.2 * contact.normal_force);
}

}  // namespace
}  // namespace softfinger
