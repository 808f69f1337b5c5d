// Where in the world a scene stands, how it is turned, in which time and behind which mirror makes
// no difference to what happens in it.
#include <gtest/gtest.h>
#include <algorithm>

#include "drawn_exploration.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger::relations {
namespace {

// Both sides solve each step to a residual of 1e-6; what rounding does before is far below. A
// touch in steps of 1 ms forgets such differences, it does not pile them up.
constexpr double kSolved = 1e-4;
// A point inside a triangle may be found one step earlier or later.
constexpr double kFeatures = 0.06;
// Samples pass an edge.
constexpr double kSharp = 0.01;
// The second derivative of a grid's distance is only continuous: what rounding decides counts more.
constexpr double kGrid = 1e-3;

double tolerance(int number, std::initializer_list<Thing> things) {
  const Thing thing = things.begin()[static_cast<std::size_t>(number) % things.size()];
  if (thing == Thing::kMesh) return kGrid;
  for (const Thing smooth : kSmoothThings) {
    if (thing == smooth) return kSolved;
  }
  return kSharp;
}

void expect_near(const Trace& a, const Trace& b, const Pose& X_VW, double tolerance,
                 const Exploration& exploration) {
  ASSERT_GT(a.most_force, 0.005) << exploration.what << ": touches nothing";
  expect_agreement(departure(a, b, X_VW), exploration, tolerance);
}
void expect_near(const Exploration& one, const Exploration& other, const Pose& X_VW,
                 double tolerance) {
  expect_near(explore(one), explore(other), X_VW, tolerance, one);
}

/// With points inside triangles, and of the samples alone.
void expect_alike(const Exploration& one, const Exploration& other, const Pose& X_VW, int number,
                  std::initializer_list<Thing> things) {
  expect_near(one, other, X_VW, kFeatures);
  expect_near(of_samples(one), of_samples(other), X_VW, tolerance(number, things));
}

const std::initializer_list<Thing> kThings{Thing::kPlane,    Thing::kBlock, Thing::kBall,
                                           Thing::kCylinder, Thing::kMesh,  Thing::kEdge};

// The scripted path is turned with the scene by its waypoints, as a scene file would.
TEST(Frames, ATurnedAndMovedSceneIsTheSame) {
  for (int number = 0; number < cases(10); ++number) {
    Draw draw("turned", number);
    const Exploration exploration = draw_exploration(draw, number, kThings);
    const Pose X_VW = draw.pose(0.3);
    expect_alike(exploration, moved(exploration, X_VW), X_VW, number, kThings);
  }
}

// A bead is met by points inside triangles alone.
TEST(Frames, ATurnedPlateOrBeadIsTheSame) {
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("turned plate", number);
    const Exploration exploration = draw_exploration(draw, number, {Thing::kPlate, Thing::kBead});
    const Pose X_VW = draw.pose(0.3);
    expect_near(exploration, moved(exploration, X_VW), X_VW, kFeatures);
    if (number % 2 != 0) continue;
    expect_near(of_samples(exploration), of_samples(moved(exploration, X_VW)), X_VW, kSharp);
  }
}

TEST(Frames, ALaterSceneIsTheSame) {
  for (int number = 0; number < cases(5); ++number) {
    Draw draw("later", number);
    const Exploration exploration = draw_exploration(draw, number, kThings);
    expect_alike(exploration, moved(exploration, {}, draw.between(0.1, 100.0)), {}, number,
                 kThings);
  }
}

/// Everything behind a mirror at y = 0.
Exploration mirrored(const Exploration& exploration) {
  const Matrix3 mirror = Vector3(1.0, -1.0, 1.0).asDiagonal();
  Exploration result = exploration;
  auto model = std::make_shared<FingerModel>(*exploration.model);
  for (Vector3& node : model->mesh.nodes) node.y() = -node.y();
  // What was right-handed and outward is so again with two corners exchanged.
  for (auto& tetrahedron : model->mesh.tetrahedra) std::swap(tetrahedron[0], tetrahedron[1]);
  for (auto& triangle : model->mesh.triangles) std::swap(triangle[0], triangle[1]);
  for (auto& triangle : model->skin_triangles) std::swap(triangle[0], triangle[1]);
  result.model = model;
  const auto reflected = [&](const Trajectory& motion) {
    std::vector<Waypoint> waypoints = motion.waypoints();
    for (Waypoint& waypoint : waypoints) {
      waypoint.pose.rotation = mirror * waypoint.pose.rotation * mirror;
      waypoint.pose.translation.y() = -waypoint.pose.translation.y();
    }
    return Trajectory(std::move(waypoints));
  };
  result.motion = reflected(exploration.motion);
  for (VirtualObject& object : result.objects) object.motion = reflected(object.motion);
  return result;
}

// Of shapes that are their own mirror image.
TEST(Frames, AMirroredSceneIsTheMirroredSame) {
  const std::initializer_list<Thing> things{Thing::kPlane, Thing::kBlock, Thing::kBall,
                                            Thing::kCylinder, Thing::kEdge};
  for (int number = 0; number < cases(5); ++number) {
    Draw draw("mirrored", number);
    const Exploration exploration = draw_exploration(draw, number, things);
    for (const bool features : {true, false}) {
      const Exploration seen = features ? exploration : of_samples(exploration);
      const Trace a = explore(seen);
      Trace b = explore(mirrored(seen));
      for (Moment& moment : b.moments) {
        moment.force_W.y() = -moment.force_W.y();
        moment.X_WF.translation.y() = -moment.X_WF.translation.y();
      }
      expect_near(a, b, {}, features ? kFeatures : tolerance(number, things), seen);
    }
  }
}

}  // namespace
}  // namespace softfinger::relations
