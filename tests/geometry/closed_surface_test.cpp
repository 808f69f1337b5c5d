#include "softfinger/geometry/closed_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "generated_mesh.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/geometry/surface_check.hpp"
#include "softfinger/geometry/vertex_weld.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string complaint_about(const TriangleMesh& mesh) {
  try {
    const ClosedSurface surface = closed_surface(mesh, "part.stl");
    check_surface(surface, TriangleTree(surface), "part.stl");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

Pose at(double x, double y, double z) { return {Matrix3::Identity(), {x, y, z}}; }

TEST(ClosedSurface, AcceptsSolids) {
  EXPECT_EQ(complaint_about(sphere_mesh(0.01, 8)), "no error");
  EXPECT_EQ(complaint_about(torus_mesh(0.02, 0.008, 40, 20)), "no error");
  EXPECT_EQ(complaint_about(tunnel_mesh(0.01, 0.004)), "no error");
  EXPECT_EQ(complaint_about(wedge_mesh(0.3, 0.01, 0.02)), "no error");
}

TEST(ClosedSurface, VolumeOfEachPart) {
  const TriangleMesh two =
      together(box_mesh({0.01, 0.02, 0.03}), moved(box_mesh({0.01, 0.01, 0.01}), at(0.1, 0, 0)));
  const ClosedSurface surface = closed_surface(two, "two");
  ASSERT_EQ(surface.part_volume.size(), 2u);
  EXPECT_NEAR(surface.part_volume[0], 8 * 6e-6, 1e-12);
  EXPECT_NEAR(surface.part_volume[1], 8e-6, 1e-12);
}

TEST(ClosedSurface, RefusesAnOpenOneAndSaysWhere) {
  TriangleMesh mesh = box_mesh({0.01, 0.01, 0.01});
  const Vector3 corner = mesh.positions[static_cast<std::size_t>(mesh.triangles.back()[0])];
  mesh.triangles.pop_back();
  EXPECT_THAT(complaint_about(mesh),
              AllOf(HasSubstr("part.stl: "), HasSubstr("open: 3 boundary edges")));
  EXPECT_NEAR(corner.cwiseAbs().maxCoeff(), 0.01, 1e-12);
}

TEST(ClosedSurface, RefusesBranchesTurnedNeighboursAndInsideOut) {
  TriangleMesh fin = box_mesh({0.01, 0.01, 0.01});
  fin.triangles.push_back(fin.triangles.front());
  std::swap(fin.triangles.back()[0], fin.triangles.back()[1]);
  fin.triangles.push_back(fin.triangles.front());
  EXPECT_THAT(complaint_about(fin), HasSubstr("branches: 3 edges"));
  TriangleMesh turned = box_mesh({0.01, 0.01, 0.01});
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_THAT(complaint_about(turned), HasSubstr("face opposite ways at 3 edges"));
  EXPECT_THAT(complaint_about(inside_out(sphere_mesh(0.01, 4))),
              AllOf(HasSubstr("inside out"), HasSubstr("mm^3")));
}

TEST(ClosedSurface, RefusesWhatIsFoldedFlat) {
  // A corner of an octahedron pressed flat from inside against the far face.
  TriangleMesh mesh;
  mesh.positions = {
      {-15. / 32, 0.5, 1. / 32}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  EXPECT_THAT(complaint_about(mesh), HasSubstr("folded flat onto itself near"));
}

TEST(ClosedSurface, RefusesWhatPassesThroughItself) {
  const TriangleMesh sphere = sphere_mesh(0.01, 6);
  EXPECT_THAT(complaint_about(together(sphere, moved(sphere, at(0.015, 0, 0)))),
              AllOf(HasSubstr("passes through itself"), HasSubstr("mm; expected none")));
  // One vertex pushed through the far side.
  TriangleMesh dented = sphere_mesh(0.01, 6);
  dented.positions[10] *= -1.5;
  EXPECT_THAT(complaint_about(dented), HasSubstr("passes through itself"));
}

TEST(ClosedSurface, PartsBesideEachOtherAndCavities) {
  const TriangleMesh large = sphere_mesh(0.02, 8);
  const TriangleMesh small = sphere_mesh(0.005, 5);
  EXPECT_EQ(complaint_about(together(large, moved(small, at(0.03, 0, 0)))), "no error");
  EXPECT_EQ(complaint_about(together(large, inside_out(small))), "no error");
  EXPECT_EQ(complaint_about(together(together(large, inside_out(sphere_mesh(0.01, 6))), small)),
            "no error");
  EXPECT_THAT(complaint_about(together(large, small)), HasSubstr("lies inside another"));
  EXPECT_THAT(complaint_about(together(large, moved(inside_out(small), at(0.03, 0, 0)))),
              HasSubstr("is inside out"));
}

TEST(ClosedSurface, TouchingTrianglesAreNoCrossing) {
  // Two boxes face to face, and one whose corner rests on a face.
  const TriangleMesh box = box_mesh({0.01, 0.01, 0.01});
  EXPECT_EQ(complaint_about(together(box, moved(box, at(0.02 + 1e-9, 0.003, 0.004)))), "no error");
  const Matrix3 turn = exp_rotation(Vector3(std::numbers::pi / 4, std::atan(std::sqrt(0.5)), 0));
  TriangleMesh resting = moved(box, {turn, Vector3::Zero()});
  double lowest = 0.0;
  for (const Vector3& p : resting.positions) lowest = std::min(lowest, p.z());
  EXPECT_EQ(complaint_about(together(box, moved(resting, at(0.0011, 0.0007, 0.01 - lowest)))),
            "no error");
}

TEST(VertexWeld, JoinsASoupAndItsCracks) {
  const TriangleMesh box = box_mesh({0.01, 0.02, 0.03}, 4);
  TriangleMesh soup;
  for (const auto& t : box.triangles) {
    const auto first = static_cast<int>(soup.positions.size());
    for (const int vertex : t) {
      // Each copy off by some nanometres.
      soup.positions.push_back(box.positions[static_cast<std::size_t>(vertex)] +
                               1e-9 * Vector3(first % 3, first % 5, first % 7));
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(welded(soup, 1e-7).positions.size(), box.positions.size());
  EXPECT_EQ(complaint_about(welded(soup, 1e-7)), "no error");
  EXPECT_THAT(complaint_about(welded(soup, 0.0)), HasSubstr("open"));
}

}  // namespace
}  // namespace softfinger
