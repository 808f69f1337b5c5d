#include "softfinger/fem/dilatation_patches.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "../support/box_mesh.hpp"

namespace softfinger {
namespace {

/// Members of `patch` reached from its first one across shared faces.
std::size_t reached(const std::vector<Tetrahedron>& tetrahedra, const std::vector<int>& members) {
  const auto shares_face = [&](int a, int b) {
    int shared = 0;
    for (const int n : tetrahedra[static_cast<std::size_t>(a)]) {
      for (const int m : tetrahedra[static_cast<std::size_t>(b)]) shared += n == m ? 1 : 0;
    }
    return shared == 3;
  };
  std::set<int> seen{members.front()};
  for (bool grown = true; grown;) {
    grown = false;
    for (const int m : members) {
      if (seen.contains(m)) continue;
      for (const int s : seen) {
        if (!shares_face(m, s)) continue;
        seen.insert(m);
        grown = true;
        break;
      }
    }
  }
  return seen.size();
}

TEST(DilatationPatches, AreConnectedOfOneMaterialAndOfAboutFour) {
  const TetrahedralMesh mesh =
      testing_support::box_mesh(5, 4, 3, Vector3::Zero(), Vector3(5, 4, 3) * 1e-3);
  std::vector<int> material(mesh.tetrahedra.size(), 0);
  for (std::size_t t = 0; t < material.size(); ++t) {
    material[t] = static_cast<int>(t % 100 < 40) - static_cast<int>(t < 7);
  }
  const std::vector<int> patch = dilatation_patches(mesh.nodes, mesh.tetrahedra, material);
  std::map<int, std::vector<int>> members;
  for (std::size_t t = 0; t < patch.size(); ++t) {
    EXPECT_EQ(patch[t] < 0, material[t] < 0);
    if (patch[t] >= 0) members[patch[t]].push_back(static_cast<int>(t));
  }
  std::size_t tetrahedra = 0;
  std::size_t small = 0;
  for (const auto& [p, list] : members) {
    tetrahedra += list.size();
    small += list.size() < 3 ? 1U : 0U;
    EXPECT_LE(list.size(), 8U);
    EXPECT_EQ(reached(mesh.tetrahedra, list), list.size());
    for (const int t : list) {
      EXPECT_EQ(material[static_cast<std::size_t>(t)],
                material[static_cast<std::size_t>(list.front())]);
    }
  }
  EXPECT_EQ(members.rbegin()->first + 1, static_cast<int>(members.size()));
  EXPECT_NEAR(static_cast<double>(tetrahedra) / static_cast<double>(members.size()), 4.0, 0.5);
  EXPECT_LT(small, members.size() / 8);
}

// A wearer of another size has the same patches: force would jump with the size.
TEST(DilatationPatches, AreThoseOfTheMeshWhateverItsSize) {
  const TetrahedralMesh mesh =
      testing_support::box_mesh(6, 4, 5, Vector3(-3, -2, -2.5) * 1e-3, Vector3(3, 2, 2.5) * 1e-3);
  const std::vector<int> material(mesh.tetrahedra.size(), 0);
  const std::vector<int> patch = dilatation_patches(mesh.nodes, mesh.tetrahedra, material);
  for (const Vector3& scale : {Vector3(1.1, 0.93, 1.07), Vector3(1.0 + 1e-7, 1.0, 1.0 - 1e-7)}) {
    std::vector<Vector3> nodes = mesh.nodes;
    for (Vector3& node : nodes) node = node.cwiseProduct(scale) + Vector3(1e-3, 0.0, -7e-3);
    EXPECT_EQ(dilatation_patches(nodes, mesh.tetrahedra, material), patch) << scale.transpose();
  }
}

}  // namespace
}  // namespace softfinger
