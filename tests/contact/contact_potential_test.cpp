#include "softfinger/contact/contact_potential.hpp"

#include <gtest/gtest.h>

#include <random>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kSamples = 200;
constexpr ContactPotential::Options kOptions;

/// Obstacles of every kind but meshes, some out of reach of most samples.
struct Crowd {
  explicit Crowd(std::mt19937& random) {
    std::uniform_real_distribution<double> place(-10.0, 10.0);
    std::normal_distribution<double> turn(0.0, 1.0);
    shapes.emplace_back(HalfSpace{});
    for (int i = 0; i < 8; ++i) {
      shapes.emplace_back(Ball{(1.0 + 0.3 * i) * mm});
      shapes.emplace_back(RoundedBox{Vector3(0.5 + 0.2 * i, 1.0, 2.0) * mm, 0.2 * mm});
      shapes.emplace_back(RoundedCylinder{0.5 * mm, 2.0 * mm, 0.1 * mm});
    }
    for (const Shape& shape : shapes) {
      Obstacle obstacle;
      obstacle.shape = &shape;
      obstacle.X_WO.rotation = exp_rotation(Vector3(turn(random), turn(random), turn(random)));
      obstacle.X_WO.translation = Vector3(place(random), place(random), place(random)) * mm;
      obstacle.friction_coefficient = 0.5;
      obstacles.push_back(obstacle);
    }
    obstacles[0].X_WO = {Matrix3::Identity(), Vector3(0.0, 0.0, -7.0 * mm)};
  }
  std::vector<Shape> shapes;
  std::vector<Obstacle> obstacles;
};

std::vector<Vector3> random_points(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-10.0, 10.0);
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < kSamples; ++i) {
    points.push_back(Vector3(place(random), place(random), place(random)) * mm);
  }
  return points;
}

// Passing over what is out of reach changes no bit of a sum that leaves nothing out.
TEST(ContactPotential, LeavesOutNothingThatCounts) {
  std::mt19937 random(5);
  const Crowd crowd(random);
  const std::size_t count = crowd.obstacles.size();
  ContactPotential potential(std::vector<double>(kSamples, 2.0 * mm2), kSamples, count, kOptions);
  const double stiffness = kOptions.stiffness_per_area * 2.0 * mm2;
  const std::vector<FrictionAnchor> anchors = potential.no_anchors();
  potential.begin(crowd.obstacles, anchors);
  int touching = 0;
  for (int round = 0; round < 20; ++round) {
    const std::vector<Vector3> points = random_points(random);
    std::vector<Vector3> gradient(kSamples, Vector3::Zero());
    const double energy = potential.energy_gradient(points, gradient);
    double expected_energy = 0.0;
    for (std::size_t i = 0; i < kSamples; ++i) {
      Vector3 expected_gradient = Vector3::Zero();
      Matrix3 expected_hessian = Matrix3::Zero();
      double least = 1.0;
      int nearest = -1;
      for (std::size_t o = 0; o < count; ++o) {
        const Obstacle& obstacle = crowd.obstacles[o];
        const SignedDistance d =
            signed_distance(*obstacle.shape, obstacle.X_WO.inverse() * points[i]);
        if (d.distance < least) {
          least = d.distance;
          nearest = static_cast<int>(o);
        }
        if (d.distance >= 0.0) continue;
        ++touching;
        const Matrix3& R = obstacle.X_WO.rotation;
        const double pressing = -stiffness * d.distance;
        const Vector3 normal = R * d.gradient;
        expected_energy += 0.5 * pressing * -d.distance;
        expected_gradient -= pressing * normal;
        expected_hessian += stiffness * normal * normal.transpose();
        expected_hessian -= pressing * Matrix3(R * d.hessian * R.transpose());
      }
      Matrix3 hessian;
      potential.hessian(i, true, hessian);
      EXPECT_EQ(gradient[i], expected_gradient);
      EXPECT_LE((hessian - expected_hessian).norm(), 1e-14 * expected_hessian.norm());
      EXPECT_EQ(potential.nearest(i).obstacle, nearest);
      EXPECT_EQ(potential.nearest(i).gap, least);
      EXPECT_LE(potential.gap(i), least);
      EXPECT_EQ(potential.respond(i, points[i]).gradient, expected_gradient);
    }
    EXPECT_EQ(energy, expected_energy);
  }
  EXPECT_GT(touching, 500);
}

// Friction ties a sample to its obstacle however far it has gone.
TEST(ContactPotential, FrictionReachesBeyondTheBox) {
  const Shape ball = Ball{1.0 * mm};
  Obstacle obstacle;
  obstacle.shape = &ball;
  obstacle.friction_coefficient = 0.5;
  ContactPotential potential({2.0 * mm2}, 1, 1, kOptions);
  std::vector<FrictionAnchor> anchors = potential.no_anchors();
  anchors[0] = {Vector3(0.0, 0.0, 1.0 * mm), Vector3::UnitZ(), 0.1};
  potential.begin({&obstacle, 1}, anchors);
  const std::vector<Vector3> point{Vector3(50.0 * mm, 0.0, 1.0 * mm)};
  std::vector<Vector3> gradient(1, Vector3::Zero());
  potential.energy_gradient(point, gradient);
  EXPECT_NEAR((gradient[0] - Vector3(0.1, 0.0, 0.0)).norm(), 0.0, 1e-12);
  // And lets go: neither force nor memory of it is left.
  EXPECT_NEAR(potential.update_anchors(point, anchors), 0.1, 1e-12);
  EXPECT_EQ(anchors[0].limit, 0.0);
  potential.begin({&obstacle, 1}, anchors);
  gradient[0].setZero();
  EXPECT_EQ(potential.energy_gradient(point, gradient), 0.0);
  EXPECT_EQ(gradient[0], Vector3::Zero());
  EXPECT_EQ(potential.forces(0).tangential, Vector3::Zero());
}

}  // namespace
}  // namespace softfinger
