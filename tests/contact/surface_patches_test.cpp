// Samples that meet a surface which deforms.
#include "softfinger/contact/surface_patches.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// One tetrahedron whose face across from its first node can be touched.
TetrahedralMesh corner_mesh() {
  TetrahedralMesh mesh;
  mesh.nodes = {Vector3::Zero(), Vector3(20, 0, 0) * mm, Vector3(0, 20, 0) * mm,
                Vector3(0, 0, 20) * mm};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  mesh.tetrahedron_volume = {0};
  mesh.triangles = {{1, 2, 3}};
  mesh.triangle_surface = {0};
  mesh.surface_names = {"surface"};
  return mesh;
}

const Vector3 kOutward = Vector3::Ones().normalized();

TEST(DeformingSurface, FindsThePlaceWhereItStandsNow) {
  TetrahedralMesh mesh = corner_mesh();
  DeformingSurface surface(mesh, "surface");
  for (Vector3& node : mesh.nodes) node = 1.2 * node + Vector3(5, 0, 0) * mm;
  surface.put(mesh.nodes);
  const Vector3 middle = (mesh.nodes[1] + mesh.nodes[2] + mesh.nodes[3]) / 3.0;
  DeformingSurface::Place place;
  ASSERT_TRUE(surface.find(middle + 1.0 * mm * kOutward, 3.0 * mm, -1, place));
  EXPECT_LT((place.at(mesh.nodes) - middle).norm(), 1e-12);
  const Pose X_WP = surface.frame(place);
  EXPECT_LT((X_WP.translation - middle).norm(), 1e-12);
  EXPECT_GT(X_WP.rotation.col(2).dot(kOutward), 0.99);
  EXPECT_LT((X_WP.rotation * X_WP.rotation.transpose() - Matrix3::Identity()).norm(), 1e-12);
  EXPECT_FALSE(surface.find(middle + 4.0 * mm * kOutward, 3.0 * mm, -1, place));
}

TEST(DeformingSurface, HasPartsThatCannotBeTouched) {
  const DeformingSurface surface(corner_mesh(), "surface");
  DeformingSurface::Place place;
  EXPECT_FALSE(surface.find(Vector3(5, 5, -1) * mm, 3.0 * mm, -1, place));
  EXPECT_FALSE(surface.find(Vector3(5, -1, 5) * mm, 3.0 * mm, -1, place));
}

/// A sample that sticks, its anchor 0.1 mm off along the surface.
TEST(SurfacePatches, FrictionGoesOnAsFarFromItsAnchorWhenThePatchMoves) {
  TetrahedralMesh mesh = corner_mesh();
  DeformingSurface surface(mesh, "surface");
  SurfacePatches patches(1);
  std::vector<FrictionAnchor> anchors(1);
  const Vector3 middle = (mesh.nodes[1] + mesh.nodes[2] + mesh.nodes[3]) / 3.0;
  std::vector<Vector3> samples{middle + 0.1 * mm * kOutward};
  patches.find(surface, samples, 0, 1, anchors);
  ASSERT_TRUE(patches.any());
  const Vector3 along = patches.patches()[0].X_WP.rotation.col(0);
  const Vector3 held = samples[0] + 0.1 * mm * along;
  anchors[0].anchor_O = patches.patches()[0].X_PW * held;
  anchors[0].normal_O = Vector3::UnitZ();
  anchors[0].limit = 1.0;

  // The object is carried and turned as a whole, the sample with it.
  const Pose moved{exp_rotation(Vector3(0.3, -0.2, 0.5)), Vector3(7, -3, 2) * mm};
  for (Vector3& node : mesh.nodes) node = moved * node;
  surface.put(mesh.nodes);
  samples[0] = moved * samples[0];
  patches.find(surface, samples, 0, 1, anchors);
  EXPECT_LT((patches.patches()[0].X_WP * anchors[0].anchor_O - moved * held).norm(), 1e-12);

  // The sample alone slides to another place.
  const Vector3 anchored = moved * held;
  samples[0] += 2.0 * mm * (moved.rotation * along);
  patches.find(surface, samples, 0, 1, anchors);
  EXPECT_LT((patches.patches()[0].X_WP * anchors[0].anchor_O - anchored).norm(), 1e-12);

  // Out of reach it is forgotten.
  samples[0] += 10.0 * mm * (moved.rotation * kOutward);
  patches.find(surface, samples, 0, 1, anchors);
  EXPECT_FALSE(patches.any());
  EXPECT_EQ(anchors[0].limit, 0.0);
}

TEST(SurfacePatches, FollowTheNodesWithoutTurning) {
  TetrahedralMesh mesh = corner_mesh();
  const DeformingSurface surface(mesh, "surface");
  SurfacePatches patches(1);
  std::vector<FrictionAnchor> anchors(1);
  const std::vector<Vector3> samples{Vector3(7, 7, 7.5) * mm};
  patches.find(surface, samples, 0, 1, anchors);
  ASSERT_TRUE(patches.patches()[0].near);
  const Matrix3 before = patches.patches()[0].X_WP.rotation;
  mesh.nodes[1] += Vector3(1, 0, 0) * mm;
  patches.follow(mesh.nodes);
  EXPECT_EQ(patches.patches()[0].X_WP.rotation, before);
  EXPECT_EQ(patches.patches()[0].X_WP.translation, patches.place(0).at(mesh.nodes));
}

/// Forces of a pair are derivatives of its energy, on the sample and on the nodes of the patch.
TEST(SurfacePatches, ForcesAreThoseOfOneEnergy) {
  TetrahedralMesh mesh = corner_mesh();
  const DeformingSurface surface(mesh, "surface");
  SurfacePatches patches(1);
  const Shape nothing = HalfSpace{};
  ContactPotential potential({1e-6}, 1, 1, {});
  std::vector<FrictionAnchor> anchors = potential.no_anchors();
  const std::vector<Vector3> samples{Vector3(6.6, 6.7, 6.6) * mm};
  patches.find(surface, samples, 0, 1, anchors);
  anchors[0].anchor_O = Vector3(2e-6, -1e-6, 0.0);
  anchors[0].limit = 1.0;
  Obstacle obstacle{.shape = &nothing, .X_WO = {}, .friction_coefficient = 0.5};
  obstacle.is_soft = true;
  obstacle.patches = patches.patches();
  const std::vector<Obstacle> obstacles{obstacle};
  potential.begin(obstacles, anchors);
  const auto energy = [&](const Vector3& sample, std::span<const Vector3> nodes) {
    patches.follow(nodes);
    std::vector<Vector3> gradient{Vector3::Zero()};
    return potential.energy_gradient(std::vector<Vector3>{sample}, gradient);
  };
  ASSERT_GT(energy(samples[0], mesh.nodes), 0.0);
  const Vector3 force = potential.patch_force(0, 0);
  ASSERT_GT(force.norm(), 0.1);
  EXPECT_LT(potential.patch_gap(0, 0), 0.0);
  const DeformingSurface::Place place = patches.place(0);
  constexpr double kWay = 1e-9;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 way = kWay * Vector3::Unit(axis);
    const double by_sample =
        (energy(samples[0] + way, mesh.nodes) - energy(samples[0] - way, mesh.nodes)) /
        (2.0 * kWay);
    EXPECT_NEAR(-by_sample, force[axis], 1e-4 * force.norm());
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<Vector3> there = mesh.nodes;
      std::vector<Vector3> back = mesh.nodes;
      there[static_cast<std::size_t>(place.nodes[k])] += way;
      back[static_cast<std::size_t>(place.nodes[k])] -= way;
      const double by_node = (energy(samples[0], there) - energy(samples[0], back)) / (2.0 * kWay);
      EXPECT_NEAR(by_node, place.weights[k] * force[axis], 1e-4 * force.norm());
    }
  }
}

}  // namespace
}  // namespace softfinger
