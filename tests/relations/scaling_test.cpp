// Dimensional analysis: lengths times l, moduli times e and densities times r make times
// l sqrt(r / e), forces e l^2, and leave everything without a unit as it was.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "drawn_exploration.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger::relations {
namespace {

struct Scales {
  double length = 1.0, modulus = 1.0, density = 1.0;

  [[nodiscard]] double time() const { return length * std::sqrt(density / modulus); }
  [[nodiscard]] double force() const { return modulus * length * length; }
};

Shape scaled(const Shape& shape, double length) {
  struct Scale {
    double length;
    Shape operator()(const HalfSpace& plane) const { return plane; }
    Shape operator()(const Ball& ball) const { return Ball{length * ball.radius}; }
    Shape operator()(const RoundedBox& box) const {
      return RoundedBox{length * box.half_size, length * box.edge_radius};
    }
    Shape operator()(const RoundedCylinder& cylinder) const {
      return RoundedCylinder{length * cylinder.radius, length * cylinder.half_length,
                             length * cylinder.edge_radius};
    }
    Shape operator()(const TaperedCapsule& bone) const {
      return TaperedCapsule{length * bone.back, length * bone.front, length * bone.half_length};
    }
    Shape operator()(const MeshShape& mesh) const { return mesh; }
  };
  return std::visit(Scale{length}, shape);
}

Exploration scaled(const Exploration& exploration, const Scales& by) {
  Exploration result = exploration;
  const double per_length = by.force() / by.length;  // N/m
  auto model = std::make_shared<FingerModel>(*exploration.model);
  for (Vector3& node : model->mesh.nodes) node *= by.length;
  for (double& area : model->sample_rest_areas) area *= by.length * by.length;
  for (FingerModel::Material& material : model->materials) {
    material.youngs_modulus *= by.modulus;
    material.density *= by.density;
  }
  for (Relaxation::Term& term : model->relaxation.terms) term.time *= by.time();
  model->strain_limits.stiffness *= by.modulus;
  model->bone_mass *= by.density * by.length * by.length * by.length;
  model->coupling.translation_stiffness *= per_length;
  model->coupling.translation_damping *= per_length * by.time();
  model->coupling.rotation_stiffness *= by.force() * by.length;
  model->coupling.rotation_damping *= by.force() * by.length * by.time();
  model->contact_tolerance *= by.length;
  result.model = model;
  const auto moved = [&](const Trajectory& motion) {
    std::vector<Waypoint> waypoints = motion.waypoints();
    for (Waypoint& waypoint : waypoints) {
      waypoint.time *= by.time();
      waypoint.pose.translation *= by.length;
    }
    return Trajectory(std::move(waypoints));
  };
  result.motion = moved(exploration.motion);
  for (VirtualObject& object : result.objects) {
    object.motion = moved(object.motion);
    object.shape = scaled(object.shape, by.length);
  }
  result.rate /= by.time();
  return result;
}

void expect_scaled(const Exploration& exploration, const Scales& by, double tolerance) {
  const Trace a = explore(exploration);
  Trace b = explore(scaled(exploration, by));
  ASSERT_GT(a.most_force, 0.01) << exploration.what;
  for (Moment& moment : b.moments) {
    moment.normal_force /= by.force();
    moment.force_W /= by.force();
    moment.X_WF.translation /= by.length;
  }
  expect_agreement(departure(a, b), exploration, tolerance,
                   fmt::format(", lengths {}, moduli {}", by.length, by.modulus));
}

const std::initializer_list<Thing> kScalable{Thing::kPlane, Thing::kBlock, Thing::kBall,
                                             Thing::kCylinder};

// Another unit of time alone: density.
TEST(Scaling, OfDensities) {
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("densities", number);
    const Exploration exploration = draw_exploration(draw, number, kScalable);
    expect_scaled(exploration, {.density = std::exp(draw.between(-1.5, 1.5))}, 1e-3);
  }
}

// The floor under forces that iterations are measured by, 1 mN, stays; a point inside a triangle
// may be found a step earlier.
TEST(Scaling, OfModuli) {
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("moduli", number);
    const Exploration exploration = draw_exploration(draw, number, kScalable);
    const Scales by{.modulus = std::exp(draw.between(-2.0, 4.6))};
    expect_scaled(exploration, by, 0.06);
    expect_scaled(of_samples(exploration), by, 2e-3);
  }
}

// Contact gives way by lengths of its own, as skin is no smoother on a smaller finger: 3 um under a
// pressure as large as the modulus. Points inside triangles lie 50 um deep, friction
// catches the skin elsewhere: both are left out.
TEST(Scaling, OfLengths) {
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("lengths", number);
    Exploration exploration = draw_exploration(draw, number, kScalable);
    exploration.objects.front().friction_coefficient = 0.0;
    expect_scaled(of_samples(exploration), {.length = draw.between(0.5, 2.0)}, 0.01);
  }
}

}  // namespace
}  // namespace softfinger::relations
