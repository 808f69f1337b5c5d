// Laws that the stepped finger must keep, on a block of tissue under a flat bone.

#include <gtest/gtest.h>

#include "../support/box_finger.hpp"
#include "softfinger/finger/finger_simulation.hpp"

namespace softfinger {
namespace {

using testing_support::box_finger;

std::vector<VirtualObject> floor_at(double z, double friction) {
  return {
      {"floor", HalfSpace{}, Trajectory(Pose{Matrix3::Identity(), Vector3(0, 0, z)}), friction}};
}

/// Runs until everything has come to rest.
void settle(FingerSimulation& finger, const Pose& X_WFt, double time_step, double duration) {
  for (int k = 1; k * time_step <= duration; ++k) {
    const StepSummary summary = finger.step(X_WFt, k * time_step);
    ASSERT_TRUE(summary.converged) << "step " << k << " residual " << summary.relative_residual;
  }
}

TEST(FingerLaws, RestStaysAtRest) {
  const std::vector<VirtualObject> none;
  FingerSimulation finger(box_finger(), none, 1e-3);
  const Pose X_WFt{exp_rotation(Vector3(0.3, -1.2, 2.0)), Vector3(0.1, 0.2, -0.3)};
  finger.reset(X_WFt);
  settle(finger, X_WFt, 1e-3, 0.2);
  for (std::size_t n = 0; n < finger.positions().size(); ++n) {
    EXPECT_LT((finger.positions()[n] - X_WFt * finger.model().mesh.nodes[n]).norm(), 1e-12);
  }
}

TEST(FingerLaws, CouplingBalancesContactAtRest) {
  for (const double dt : {1e-3, 16e-3}) {
    const auto objects = floor_at(-8e-3, 0.5);
    const auto model = box_finger();
    FingerSimulation finger(model, objects, dt);
    finger.reset(Pose{});
    const Pose X_WFt{Matrix3::Identity(), Vector3(0.0, 0.0, -3e-3)};
    settle(finger, X_WFt, dt, 3.0);
    const double pull = model->coupling.translation_stiffness *
                        (finger.bone_pose().translation.z() - X_WFt.translation.z());
    EXPECT_GT(pull, 0.1);
    double normal = 0.0;
    for (const ContactSample& s : finger.contact().samples) normal += s.normal_force;
    EXPECT_NEAR(normal, pull, 1e-5 * pull) << "time step " << dt;
  }
}

TEST(FingerLaws, SteadyForceDoesNotDependOnTheTimeStep) {
  std::vector<double> forces;
  for (const double dt : {0.5e-3, 1e-3, 8e-3}) {
    const auto objects = floor_at(-8e-3, 0.0);
    FingerSimulation finger(box_finger(), objects, dt);
    finger.reset(Pose{});
    settle(finger, Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -3e-3)}, dt, 3.0);
    forces.push_back(finger.contact().normal_force);
  }
  EXPECT_NEAR(forces[1], forces[0], 1e-5 * forces[0]);
  EXPECT_NEAR(forces[2], forces[0], 1e-5 * forces[0]);
}

TEST(FingerLaws, CarriedAtConstantSpeedEverythingMovesAlike) {
  const std::vector<VirtualObject> none;
  FingerSimulation finger(box_finger(), none, 1e-3);
  finger.reset(Pose{});
  const Vector3 velocity(0.05, -0.02, 0.03);
  Pose X_WFt;
  for (int k = 1; k <= 4000; ++k) {
    X_WFt.translation = velocity * (k * 1e-3);
    ASSERT_TRUE(finger.step(X_WFt, k * 1e-3).converged);
  }
  // No drag: the bone does not stay behind, whatever the speed.
  EXPECT_LT((finger.bone_pose().translation - X_WFt.translation).norm(), 1e-7);
  for (const Vector3& v : finger.velocities()) EXPECT_LT((v - velocity).norm(), 1e-6);
}

TEST(FingerLaws, FrictionSaturatesAtTheCoulombLimitAndHoldsWithoutCreep) {
  const double mu = 0.5;
  const auto objects = floor_at(-8e-3, mu);
  FingerSimulation finger(box_finger(), objects, 1e-3);
  finger.reset(Pose{});
  const double dt = 1e-3;
  double time = 0.0;
  Pose X_WFt;
  const auto move = [&](const Vector3& to, double duration) {
    const Vector3 from = X_WFt.translation;
    const int steps = static_cast<int>(duration / dt);
    for (int k = 1; k <= steps; ++k) {
      X_WFt.translation = from + (to - from) * k / steps;
      time += dt;
      ASSERT_TRUE(finger.step(X_WFt, time).converged);
      EXPECT_LE(finger.contact().tangential_force, mu * finger.contact().normal_force * 1.1 + 1e-3);
    }
  };
  move(Vector3(0, 0, -3e-3), 0.3);
  // A small sideways pull sticks.
  move(Vector3(0.15e-3, 0, -3e-3), 0.1);
  move(Vector3(0.15e-3, 0, -3e-3), 0.5);
  const double ratio = finger.contact().tangential_force / finger.contact().normal_force;
  EXPECT_GT(ratio, 0.01);
  EXPECT_LT(ratio, 0.9 * mu);
  const Vector3 held = finger.positions()[static_cast<std::size_t>(finger.model().sample_nodes[0])];
  move(X_WFt.translation, 0.5);
  EXPECT_LT(
      (finger.positions()[static_cast<std::size_t>(finger.model().sample_nodes[0])] - held).norm(),
      1e-9);
  // A long drag slips everywhere.
  move(Vector3(15e-3, 0, -3e-3), 0.5);
  EXPECT_NEAR(finger.contact().tangential_force / finger.contact().normal_force, mu, 2e-3 * mu);
}

TEST(FingerLaws, FrictionlessContactHasNoTangentialForce) {
  const auto objects = floor_at(-8e-3, 0.0);
  FingerSimulation finger(box_finger(), objects, 1e-3);
  finger.reset(Pose{});
  for (int k = 1; k <= 500; ++k) {
    finger.step(Pose{Matrix3::Identity(), Vector3(1e-5 * k, 0, -3e-3)}, k * 1e-3);
    EXPECT_EQ(finger.contact().tangential_force, 0.0);
  }
}

TEST(FingerLaws, AnObjectThatMovesAwayIsNoLongerTouched) {
  std::vector<VirtualObject> objects = floor_at(-8e-3, 0.5);
  objects[0].motion =
      Trajectory(std::vector<Waypoint>{{0.2, Pose{Matrix3::Identity(), Vector3(0, 0, -6e-3)}},
                                       {0.6, Pose{Matrix3::Identity(), Vector3(0, 0, -12e-3)}}});
  FingerSimulation finger(box_finger(), objects, 1e-3);
  finger.reset(Pose{});
  for (int k = 1; k <= 200; ++k) ASSERT_TRUE(finger.step(Pose{}, k * 1e-3).converged);
  EXPECT_GT(finger.contact().normal_force, 0.05);
  for (int k = 201; k <= 700; ++k) ASSERT_TRUE(finger.step(Pose{}, k * 1e-3).converged);
  EXPECT_EQ(finger.contact().contact_count, 0);
  EXPECT_GT(finger.contact().least_gap, 4e-3);
}

TEST(FingerLaws, ViolentTrackingConvergesAndRecovers) {
  const auto objects = floor_at(-8e-3, 0.5);
  FingerSimulation finger(box_finger(), objects, 1e-3);
  finger.reset(Pose{});
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Pose X_WFt;
  int unconverged = 0;
  for (int k = 1; k <= 2000; ++k) {
    if (k % 48 == 0) {
      X_WFt.translation = 11.5e-3 * Vector3(unit(generator), unit(generator), unit(generator));
      X_WFt.rotation =
          exp_rotation(0.45 * Vector3(unit(generator), unit(generator), unit(generator)));
    }
    unconverged += finger.step(X_WFt, k * 1e-3).converged ? 0 : 1;
    for (const Vector3& x : finger.positions()) ASSERT_TRUE(x.allFinite());
  }
  EXPECT_EQ(unconverged, 0);
}

TEST(FingerLaws, SameMotionGivesTheSameBits) {
  const auto objects = floor_at(-8e-3, 0.5);
  std::vector<std::uint64_t> hashes[2];
  for (auto& run : hashes) {
    FingerSimulation finger(box_finger(), objects, 1e-3);
    finger.reset(Pose{});
    for (int k = 1; k <= 300; ++k) {
      finger.step(Pose{exp_rotation(Vector3(0, 1e-3 * k, 0)), Vector3(0, 0, -1.5e-5 * k)},
                  k * 1e-3);
      run.push_back(finger.state_hash());
    }
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace softfinger
