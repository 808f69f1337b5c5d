// One surface described in several ways is touched in one way.
#include <gtest/gtest.h>

#include "../geometry/generated_mesh.hpp"
#include "drawn_exploration.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger::relations {
namespace {

Exploration on(const Exploration& exploration, Shape shape, const Vector3& place,
               const Matrix3& turn = Matrix3::Identity()) {
  Exploration other = exploration;
  other.objects.front().shape = std::move(shape);
  other.objects.front().motion = Trajectory(Pose{turn, place});
  return other;
}

void expect_alike(const Trace& plane, const Exploration& exploration, const char* what,
                  double tolerance) {
  const Departure most = departure(plane, explore(exploration));
  EXPECT_LT(most.normal_force, tolerance) << exploration.what << ", as " << what << most.where;
  EXPECT_LT(most.force, tolerance) << exploration.what << ", as " << what << most.where;
}

// Exact but for rounding (box, end of a cylinder) and for interpolation of the grid (mesh). A ball
// of 20 m departs from its tangent plane by 0.1 um within 2 mm of the middle and 1.6 um within 8.
TEST(Shapes, PlaneBoxCylinderMeshAndLargeBall) {
  static const MeshShape block = solid_of(box_mesh(Vector3(25, 25, 8) * mm));
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("plane", number);
    const Exploration exploration = draw_exploration(draw, number, {Thing::kPlane});
    const Trace plane = explore(exploration);
    ASSERT_GT(plane.most_force, 0.01) << exploration.what;
    const Matrix3 spin = exp_rotation({0.0, 0.0, draw.between(-3.0, 3.0)});
    expect_alike(
        plane,
        on(exploration, RoundedBox{Vector3(30, 30, 10) * mm, 1 * mm}, {0.0, 0.0, -10 * mm}, spin),
        "box", 1e-4);
    expect_alike(
        plane,
        on(exploration, RoundedCylinder{30 * mm, 10 * mm, 1 * mm}, {0.0, 0.0, -10 * mm}, spin),
        "end of a cylinder", 1e-4);
    expect_alike(plane, on(exploration, block, {0.0, 0.0, -8 * mm}), "mesh", 5e-3);
    expect_alike(plane, on(exploration, Ball{20.0}, {0.0, 0.0, -20.0}), "large ball", 0.01);
  }
}

// A plate is a block to who only sees its face, as far as its rounding: none of either.
TEST(Shapes, AThinPlateAndABlock) {
  for (int number = 0; number < cases(3); ++number) {
    Draw draw("plate", number);
    const Exploration plate = draw_exploration(draw, number, {Thing::kPlate});
    const Trace block =
        explore(on(plate, RoundedBox{Vector3(30, 30, 10) * mm, 0.0}, {0.0, 0.0, -10 * mm}));
    ASSERT_GT(block.most_force, 0.01) << plate.what;
    Exploration thin = plate;
    thin.objects.front().motion =
        Trajectory(Pose{Matrix3::Identity(), plate.objects.front().motion.sample(0.0).translation});
    expect_alike(block, thin, "thin plate", 0.01);
  }
}

// Of 12 mm, its facets 0.2 mm long and less than a micrometre inside the ball; what the grid of 0.4
// mm interpolates is as near.
TEST(Shapes, ABallAndOneOfTriangles) {
  static const MeshShape triangles = solid_of(sphere_mesh(12 * mm, 60));
  for (int number = 0; number < cases(3); ++number) {
    Draw draw("ball", number);
    Exploration exploration =
        draw_exploration(draw, number, {Thing::kMesh}, {Path::kPress, Path::kSlide});
    exploration = on(exploration, Ball{12 * mm}, {0.0, 0.0, -12 * mm});
    const Trace ball = explore(exploration);
    ASSERT_GT(ball.most_force, 0.01) << exploration.what;
    const Trace mesh = explore(on(exploration, triangles, {0.0, 0.0, -12 * mm}));
    // On the way a point inside a triangle may be met a step earlier.
    EXPECT_LT(departure(ball, mesh).normal_force, 0.2) << exploration.what;
    EXPECT_LT((mesh.last().force_W - ball.last().force_W).norm(), 0.02 * ball.last().normal_force)
        << exploration.what;
  }
}

/// The same with the finger standing still and the object coming, the other way.
Exploration reversed(const Exploration& exploration) {
  Exploration result = exploration;
  const std::vector<Waypoint>& waypoints = exploration.motion.waypoints();
  result.motion =
      Trajectory({waypoints.front(), {exploration.motion.end_time(), waypoints.front().pose}});
  const Pose X_WO = exploration.objects.front().motion.sample(0.0);
  std::vector<Waypoint> opposite;
  for (const Waypoint& waypoint : waypoints) {
    Pose pose = X_WO;
    pose.translation += waypoints.front().pose.translation - waypoint.pose.translation;
    opposite.push_back({waypoint.time, pose});
  }
  result.objects.front().motion = Trajectory(opposite);
  return result;
}

// What the finger does to the object the object may do to the finger: paths without turns, slow
// enough that accelerating the bone, 10 g, takes little force. At rest at the end; on the way the
// bone's inertia tells who moves, and friction remembers how far the skin swung where a slide
// ended, by what points inside a triangle that caught then bear.
TEST(Shapes, ObjectToFingerAndFingerToObject) {
  int at_rest = 0;
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("reversed", number);
    const Exploration drawn =
        draw_exploration(draw, number, kSmoothThings, {Path::kPress, Path::kSlide});
    for (const bool rubs : {true, false}) {
      Exploration exploration = drawn;
      if (!rubs) exploration.objects.front().friction_coefficient = 0.0;
      const Trace a = explore(exploration);
      const Trace b = explore(reversed(exploration));
      ASSERT_GT(a.most_force, 0.01) << exploration.what;
      if (a.last().normal_force < 0.01) continue;  // slid off the object
      ++at_rest;
      const double force = a.last().normal_force;
      EXPECT_NEAR(b.last().normal_force, force, (rubs ? 0.1 : 0.02) * force) << exploration.what;
      EXPECT_LT((b.last().force_W - a.last().force_W).norm(), (rubs ? 0.3 : 0.02) * force)
          << exploration.what;
      EXPECT_LT(departure(a, b).normal_force, 0.3) << exploration.what;
    }
  }
  EXPECT_GT(at_rest, 0);
}

}  // namespace
}  // namespace softfinger::relations
