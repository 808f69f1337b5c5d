// What the potential of contact must do whatever the obstacle: derive, move along, balance, rub.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/contact/contact_potential.hpp"

namespace softfinger {
namespace {

constexpr double kMicrometre = 1e-3 * mm;
constexpr ContactPotential::Options kLawOptions;
constexpr double kArea = 2.0 * mm2;
constexpr double kStiffness = kLawOptions.stiffness_per_area * kArea;      // N/m
constexpr double kTangential = kLawOptions.tangential_ratio * kStiffness;  // N/m
constexpr double kFriction = 0.5;

Vector3 drawn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

Pose drawn_pose(std::mt19937& random) {
  return {exp_rotation(drawn(random)), 20 * mm * drawn(random)};
}

/// One obstacle of a kind, anywhere, with points that touch it and the anchors of a step before.
struct Scene {
  Scene(const Shape& solid, std::mt19937& random)
      : shape(solid), potential(std::vector<double>(kPoints, kArea), kPoints, 1, kLawOptions) {
    obstacle.shape = &shape;
    obstacle.X_WO = drawn_pose(random);
    obstacle.friction_coefficient = kFriction;
    anchors = potential.no_anchors();
    for (std::size_t i = 0; i < kPoints; ++i) {
      // From somewhere near to some micrometres below the surface.
      Vector3 p_O = 1.5 * mm * drawn(random);
      for (int k = 0; k < 3; ++k) {
        const SignedDistance at = signed_distance(shape, p_O);
        p_O -= (at.distance + (3.0 + static_cast<double>(i % 7)) * kMicrometre) * at.gradient;
      }
      const SignedDistance at = signed_distance(shape, p_O);
      anchors[i] = {
          p_O + 2 * kMicrometre * drawn(random), at.gradient, i % 3 == 0 ? 1e-4 : 1.0, {}};
      points.push_back(obstacle.X_WO * p_O);
    }
    potential.begin({&obstacle, 1}, anchors);
  }

  double energy(const std::vector<Vector3>& at) {
    std::vector<Vector3> unused(kPoints, Vector3::Zero());
    return potential.energy_gradient(at, unused);
  }
  std::vector<Vector3> gradient(const std::vector<Vector3>& at) {
    std::vector<Vector3> sum(kPoints, Vector3::Zero());
    potential.energy_gradient(at, sum);
    return sum;
  }

  static constexpr std::size_t kPoints = 24;
  Shape shape;
  Obstacle obstacle;
  ContactPotential potential;
  std::vector<FrictionAnchor> anchors;
  std::vector<Vector3> points;
};

std::vector<Shape> solids() {
  return {HalfSpace{}, Ball{4 * mm}, RoundedBox{Vector3(1, 2, 3) * mm, 0.5 * mm},
          RoundedCylinder{2 * mm, 3 * mm, 0.5 * mm}};
}

TEST(ContactLaws, GradientAndHessianAreTheEnergysDerivatives) {
  std::mt19937 random(1);
  constexpr double kStep = 1e-9;
  for (const Shape& solid : solids()) {
    Scene scene(solid, random);
    int sliding = 0;
    for (std::size_t i = 0; i < Scene::kPoints; ++i) {
      const Vector3 gradient = scene.gradient(scene.points)[i];
      Matrix3 hessian;
      ASSERT_TRUE(scene.potential.hessian(i, true, hessian));
      sliding += scene.potential.forces(i).slides ? 1 : 0;
      Vector3 slope;
      Matrix3 curvature;
      for (int k = 0; k < 3; ++k) {
        std::array<double, 2> energies{};
        std::array<Vector3, 2> gradients;
        for (std::size_t side = 0; side < 2; ++side) {
          std::vector<Vector3> moved = scene.points;
          moved[i][k] += side == 0 ? -kStep : kStep;
          energies[side] = scene.energy(moved);
          gradients[side] = scene.gradient(moved)[i];
        }
        slope[k] = (energies[1] - energies[0]) / (2.0 * kStep);
        curvature.col(k) = (gradients[1] - gradients[0]) / (2.0 * kStep);
      }
      EXPECT_LT((gradient - slope).norm(), 1e-5 * gradient.norm()) << solid.index() << ' ' << i;
      EXPECT_LT((hessian - curvature).norm(), 1e-5 * hessian.norm()) << solid.index() << ' ' << i;
      EXPECT_LT((hessian - hessian.transpose()).norm(), 1e-12 * hessian.norm());
    }
    EXPECT_GT(sliding, 3) << solid.index();
    EXPECT_LT(sliding, 20) << solid.index();
  }
}

// Seen from elsewhere gaps, energies and limits are the same, and vectors turn with the view.
TEST(ContactLaws, MoveWithTheWorld) {
  std::mt19937 random(2);
  for (const Shape& solid : solids()) {
    Scene scene(solid, random);
    const Pose X_VW = drawn_pose(random);
    Scene moved = scene;
    moved.obstacle.shape = &moved.shape;
    moved.obstacle.X_WO = X_VW * scene.obstacle.X_WO;
    for (Vector3& p : moved.points) p = X_VW * p;
    moved.potential.begin({&moved.obstacle, 1}, moved.anchors);
    const double energy = scene.energy(scene.points);
    EXPECT_NEAR(moved.energy(moved.points), energy, 1e-9 * energy);
    for (std::size_t i = 0; i < Scene::kPoints; ++i) {
      const auto nearest = scene.potential.nearest(i), there = moved.potential.nearest(i);
      EXPECT_NEAR(there.gap, nearest.gap, 1e-15);
      EXPECT_LT((there.normal - X_VW.rotation * nearest.normal).norm(), 1e-9);
      const auto forces = scene.potential.forces(i), turned = moved.potential.forces(i);
      EXPECT_LT((turned.normal - X_VW.rotation * forces.normal).norm(), 1e-8);
      EXPECT_LT((turned.tangential - X_VW.rotation * forces.tangential).norm(), 1e-8);
    }
  }
}

// Nothing pulls but what is reported: the forces are what lowers the energy, each out of the solid
// and along it, and what all points feel the norm knows.
TEST(ContactLaws, ForcesAreWhatLowersTheEnergy) {
  std::mt19937 random(3);
  for (const Shape& solid : solids()) {
    Scene scene(solid, random);
    const std::vector<Vector3> gradient = scene.gradient(scene.points);
    double squares = 0.0;
    for (std::size_t i = 0; i < Scene::kPoints; ++i) {
      const ContactPotential::Forces forces = scene.potential.forces(i);
      const ContactPotential::Nearest nearest = scene.potential.nearest(i);
      EXPECT_LT((forces.normal + forces.tangential + gradient[i]).norm(), 1e-12);
      EXPECT_NEAR(forces.normal.norm(), -kStiffness * nearest.gap, 1e-9);
      EXPECT_NEAR(forces.normal.dot(nearest.normal), forces.normal_sum, 1e-12);
      EXPECT_LT(
          std::abs(forces.tangential.dot(scene.obstacle.X_WO.rotation * scene.anchors[i].normal_O)),
          1e-12);
      EXPECT_NEAR(forces.friction_limit, kFriction * forces.normal_sum, 1e-12);
      squares += gradient[i].squaredNorm();
    }
    EXPECT_NEAR(scene.potential.force_norm(), std::sqrt(squares), 1e-12);
  }
}

/// A point on the half space z <= 0 at depth `depth`, dragged step by step.
struct Dragged {
  Dragged() : potential({kArea}, 1, 1, kLawOptions), anchors(potential.no_anchors()) {
    obstacle.shape = &shape;
    obstacle.friction_coefficient = kFriction;
  }
  /// One step that ends with the point there; what it feels.
  ContactPotential::Forces step(const Vector3& p) {
    before = anchors;
    potential.begin({&obstacle, 1}, before);
    Vector3 gradient = Vector3::Zero();
    potential.energy_gradient({&p, 1}, {&gradient, 1});
    const ContactPotential::Forces forces = potential.forces(0);
    potential.update_anchors({&p, 1}, anchors);
    return forces;
  }
  Shape shape = HalfSpace{};
  Obstacle obstacle;
  ContactPotential potential;
  std::vector<FrictionAnchor> anchors, before;
};

TEST(ContactLaws, FrictionSticksThenSlidesAndNeverLeavesTheCone) {
  Dragged dragged;
  constexpr double kDepth = 5 * kMicrometre;
  const double limit = kFriction * kStiffness * kDepth;
  dragged.step({0.0, 0.0, -kDepth});
  std::mt19937 random(4);
  std::uniform_real_distribution<double> step(0.0, 0.4 * limit / kTangential);
  double x = 0.0;
  bool slid = false;
  for (int k = 0; k < 20; ++k) {
    x += step(random);
    const ContactPotential::Forces forces = dragged.step({x, 0.0, -kDepth});
    EXPECT_NEAR(forces.tangential.x(), -std::min(limit, kTangential * x), 1e-9 * limit) << k;
    EXPECT_EQ(forces.tangential.y(), 0.0);
    EXPECT_LE(forces.tangential.norm(), limit * (1.0 + 1e-12));
    slid = slid || forces.slides;
  }
  EXPECT_TRUE(slid);
  // Turned round it sticks first: the force falls by the tangential stiffness, from the limit.
  const double back = 0.3 * limit / kTangential;
  EXPECT_NEAR(dragged.step({x - back, 0.0, -kDepth}).tangential.x(), -limit + kTangential * back,
              1e-9 * limit);
  // However it is dragged, a point under the same normal force stays in the cone.
  Vector3 p(x, 0.0, -kDepth);
  for (int k = 0; k < 200; ++k) {
    const Vector3 way = 2.0 * limit / kTangential * drawn(random);
    p += Vector3(way.x(), way.y(), 0.0);
    EXPECT_LE(dragged.step(p).tangential.norm(), limit * (1.0 + 1e-12)) << k;
    EXPECT_TRUE(dragged.potential.is_in_cone());
  }
}

// The limit is that of the step before; passes of update_limits() bring it to the normal force of
// this one.
TEST(ContactLaws, LimitsFollowTheNormalForce) {
  Dragged dragged;
  dragged.step({0.0, 0.0, -8 * kMicrometre});
  const Vector3 p(1 * mm, 0.0, -2 * kMicrometre);  // far along and nearly off
  const ContactPotential::Forces lagged = dragged.step(p);
  EXPECT_NEAR(lagged.tangential.norm(), kFriction * kStiffness * 8 * kMicrometre, 1e-9);
  EXPECT_FALSE(dragged.potential.is_in_cone());
  for (const bool only_lower : {false, true}) {
    std::vector<FrictionAnchor> anchors = dragged.before;
    dragged.potential.begin({&dragged.obstacle, 1}, anchors);
    Vector3 gradient = Vector3::Zero();
    dragged.potential.energy_gradient({&p, 1}, {&gradient, 1});
    EXPECT_GT(dragged.potential.update_limits(anchors, only_lower), 0.0);
    dragged.potential.begin({&dragged.obstacle, 1}, anchors);
    dragged.potential.energy_gradient({&p, 1}, {&gradient, 1});
    EXPECT_TRUE(dragged.potential.is_in_cone());
    EXPECT_LE(dragged.potential.forces(0).tangential.norm(),
              kFriction * kStiffness * 2 * kMicrometre * (1.0 + 1e-9));
  }
}

TEST(ContactLaws, APlaneIsTheBallOfInfiniteRadius) {
  const auto touched = [](const Shape& shape, double centre_z) {
    Obstacle obstacle;
    obstacle.shape = &shape;
    obstacle.X_WO.translation.z() = centre_z;
    ContactPotential potential({kArea}, 1, 1, kLawOptions);
    const std::vector<FrictionAnchor> anchors = potential.no_anchors();
    potential.begin({&obstacle, 1}, anchors);
    const Vector3 p(0.3 * mm, -0.4 * mm, -200 * kMicrometre);  // deeper than the ball falls away
    Vector3 gradient = Vector3::Zero();
    potential.energy_gradient({&p, 1}, {&gradient, 1});
    return gradient;
  };
  const Vector3 plane = touched(HalfSpace{}, 0.0);
  EXPECT_NEAR(plane.z(), -kStiffness * 200 * kMicrometre, 1e-9);
  double last = 0.0;
  for (const double radius : {0.01, 0.1, 1.0, 10.0}) {
    const double error = (touched(Ball{radius}, -radius) - plane).norm() / plane.norm();
    if (last > 0.0) {
      EXPECT_NEAR(error / last, 0.1, 0.01) << radius;  // like 1 / radius
    }
    last = error;
  }
  EXPECT_LT(last, 1e-4);
}

// A point that meets an obstacle as a plane feels what a sample on that plane does.
TEST(ContactLaws, APointOnAPlaneFeelsAsASampleOnAHalfSpace) {
  std::mt19937 random(6);
  const Shape shape = HalfSpace{};
  Obstacle obstacle;
  obstacle.shape = &shape;
  obstacle.X_WO = drawn_pose(random);
  ContactPotential potential({kArea, kArea}, 1, 1, kLawOptions);
  const std::vector<FrictionAnchor> anchors = potential.no_anchors();
  const Vector3 normal = obstacle.X_WO.rotation.col(2);
  for (const double gap : {-5 * kMicrometre, -1 * kMicrometre, 3 * kMicrometre}) {
    const Vector3 p = obstacle.X_WO * Vector3(1 * mm, 2 * mm, gap);
    potential.begin({&obstacle, 1}, anchors);
    potential.add_plane({0, normal, -normal.dot(obstacle.X_WO.translation)});
    const std::array<Vector3, 2> points{p, p};
    std::array<Vector3, 2> gradients{Vector3::Zero(), Vector3::Zero()};
    potential.energy_gradient(points, gradients);
    EXPECT_LT((gradients[0] - gradients[1]).norm(), 1e-9);
    EXPECT_NEAR(gradients[1].norm(), std::max(0.0, -kStiffness * gap), 1e-9);
    EXPECT_NEAR(potential.nearest(1).gap, gap, 1e-12);
  }
}

}  // namespace
}  // namespace softfinger
