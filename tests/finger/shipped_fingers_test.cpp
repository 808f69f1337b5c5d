#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/geometry/tetrahedron_faces.hpp"

namespace softfinger {
namespace {

struct Expected {
  std::string name;
  std::size_t least_tetrahedra, most_tetrahedra;
  double least_angle_deg = 12.0;
  bool is_one_of_the_sizes = true;
};

/// Faces of one tetrahedron only, node indices in rising order.
std::set<Triangle> boundary_of(const TetrahedralMesh& mesh) {
  std::set<Triangle> boundary;
  for (const TetrahedronFace& face : faces_of(mesh.tetrahedra)) {
    if (!boundary.insert(face.sorted).second) boundary.erase(face.sorted);
  }
  return boundary;
}

std::ostream& operator<<(std::ostream& stream, const Expected& expected) {
  return stream << expected.name;
}

class ShippedFinger : public ::testing::TestWithParam<Expected> {
 protected:
  static std::filesystem::path folder() {
    return std::filesystem::path(source_folder()) / "fingers";
  }
  void SetUp() override { model_ = FingerModel::load(folder() / (GetParam().name + ".toml")); }

  [[nodiscard]] const Vector3& node(int index) const {
    return model_->mesh.nodes[static_cast<std::size_t>(index)];
  }
  /// Nodes of the triangles of a group.
  [[nodiscard]] std::set<int> group(const std::string& name) const {
    const TetrahedralMesh& mesh = model_->mesh;
    std::set<int> nodes;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      if (mesh.surface_names[static_cast<std::size_t>(mesh.triangle_surface[i])] == name) {
        nodes.insert(mesh.triangles[i].begin(), mesh.triangles[i].end());
      }
    }
    return nodes;
  }

  std::shared_ptr<const FingerModel> model_;
};

TEST_P(ShippedFinger, HasTheCountsOfItsSize) {
  const TetrahedralMesh& mesh = model_->mesh;
  EXPECT_GE(mesh.tetrahedra.size(), GetParam().least_tetrahedra);
  EXPECT_LE(mesh.tetrahedra.size(), GetParam().most_tetrahedra);
  if (GetParam().name != "index") return;
  std::set<int> boundary;
  for (const Triangle& triangle : boundary_of(mesh)) {
    boundary.insert(triangle.begin(), triangle.end());
  }
  for (const int bone : group("bone")) boundary.erase(bone);
  EXPECT_GE(boundary.size(), 110u);
  EXPECT_LE(boundary.size(), 130u);
}

TEST_P(ShippedFinger, EveryBoundaryFaceIsInOneGroup) {
  const TetrahedralMesh& mesh = model_->mesh;
  std::set<Triangle> grouped;
  for (const Triangle& triangle : mesh.triangles) {
    EXPECT_TRUE(grouped.insert(sorted(triangle)).second) << "in two groups";
  }
  EXPECT_EQ(grouped, boundary_of(mesh));
}

TEST_P(ShippedFinger, HasTheSizeOfAnIndexFinger) {
  Eigen::AlignedBox3d skin, bone;
  for (const int n : model_->sample_nodes) skin.extend(node(n));
  for (const int n : group("bone")) bone.extend(node(n));
  EXPECT_NEAR(skin.sizes().x(), 25e-3, 0.5e-3);
  EXPECT_NEAR(skin.sizes().y(), 16e-3, 0.5e-3);
  EXPECT_NEAR(skin.sizes().z(), 13.5e-3, 0.5e-3);
  EXPECT_NEAR(bone.sizes().x(), 16e-3, 1e-3);
  EXPECT_LT(bone.center().norm(), 0.6e-3) << "F's origin is the centre of the bone";
  const double pulp = bone.min().z() - skin.min().z();
  EXPECT_GE(pulp, 4e-3);
  EXPECT_LE(pulp, 5e-3);
  double volume = 0.0;
  for (const auto& [a, b, c, d] : model_->mesh.tetrahedra) {
    volume += (node(b) - node(a)).cross(node(c) - node(a)).dot(node(d) - node(a)) / 6.0;
  }
  EXPECT_NEAR(volume, 3200e-9, 200e-9);
}

TEST_P(ShippedFinger, NailIsDorsalAndPulpIsSkin) {
  for (const int n : group("nail")) EXPECT_GT(node(n).z(), 0.0);
  const std::set<int> samples(model_->sample_nodes.begin(), model_->sample_nodes.end());
  std::size_t on_pulp = 0;
  for (const int n : samples) {
    const Vector3& p = node(n);
    if (p.z() < -3.5e-3 && p.x() > -3e-3 && p.x() < 11e-3) {
      ++on_pulp;
      EXPECT_FALSE(model_->node_is_rigid[static_cast<std::size_t>(n)]);
    }
  }
  EXPECT_GE(4 * on_pulp, samples.size()) << "graded to the pulp";
}

TEST_P(ShippedFinger, SharesOneSetOfConstants) {
  if (!GetParam().is_one_of_the_sizes) GTEST_SKIP() << "has its own";
  auto own = nlohmann::json::parse(model_->as_read);
  auto first = nlohmann::json::parse(FingerModel::load(folder() / "index.toml")->as_read);
  own.erase("mesh");
  first.erase("mesh");
  // Fewer tetrahedra are stiffer: a finer mesh has a higher modulus for the same force.
  const double ratio = own["material"]["youngs_modulus_kPa"].get<double>() /
                       first["material"]["youngs_modulus_kPa"].get<double>();
  EXPECT_GE(ratio, 1.0);
  EXPECT_LT(ratio, 1.25);
  own["material"].erase("youngs_modulus_kPa");
  first["material"].erase("youngs_modulus_kPa");
  EXPECT_EQ(own, first);
}

TEST_P(ShippedFinger, ElementsAreWellShaped) {
  double least = 1.0;
  for (const auto& tetrahedron : model_->mesh.tetrahedra) {
    // Sine of the angle between the planes of two faces at their common edge.
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        std::array<std::size_t, 2> others{};
        for (std::size_t k = 0, count = 0; k < 4; ++k) {
          if (k != i && k != j) others[count++] = k;
        }
        const Vector3 edge = (node(tetrahedron[j]) - node(tetrahedron[i])).normalized();
        const auto across = [&](std::size_t k) {
          const Vector3 arm = node(tetrahedron[k]) - node(tetrahedron[i]);
          return Vector3((arm - arm.dot(edge) * edge).normalized());
        };
        const double angle =
            std::acos(std::clamp(across(others[0]).dot(across(others[1])), -1.0, 1.0));
        least = std::min(least, angle);
      }
    }
  }
  EXPECT_GT(least * 57.29577951308232, GetParam().least_angle_deg);
}

TEST(LayeredFinger, HasLayersOfTheThicknessItsFileSays) {
  const auto model =
      FingerModel::load(std::filesystem::path(source_folder()) / "fingers" / "index-layered.toml");
  const TetrahedralMesh& mesh = model->mesh;
  ASSERT_EQ(mesh.volume_names, (std::vector<std::string>{"epidermis", "dermis", "subcutaneous"}));
  std::array<std::set<int>, 3> nodes;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    nodes[static_cast<std::size_t>(mesh.tetrahedron_volume[t])].insert(mesh.tetrahedra[t].begin(),
                                                                       mesh.tetrahedra[t].end());
  }
  const auto between = [&](std::size_t a, std::size_t b) {
    std::vector<int> shared;
    std::ranges::set_intersection(nodes[a], nodes[b], std::back_inserter(shared));
    return shared;
  };
  // The surface lies on a thickness along its normal: the nearest node of it is as far away.
  const std::vector<int> under_epidermis = between(0, 1);
  std::set<int> surface = nodes[0];
  for (const int n : under_epidermis) surface.erase(n);
  const auto expect_depth = [&](const std::vector<int>& interface, double depth) {
    ASSERT_FALSE(interface.empty());
    for (const int n : interface) {
      double nearest = 1.0;
      for (const int s : surface) {
        nearest = std::min(nearest, (mesh.nodes[static_cast<std::size_t>(s)] -
                                     mesh.nodes[static_cast<std::size_t>(n)])
                                        .norm());
      }
      EXPECT_NEAR(nearest, depth, 2e-7);  // coordinates have six digits
    }
  };
  expect_depth(under_epidermis, 0.6e-3);
  expect_depth(between(1, 2), 1.6e-3);
  EXPECT_TRUE(between(0, 2).empty());
}

TEST(ViscoelasticFinger, IsTheDefaultFingerWithRelaxation) {
  const std::filesystem::path folder = std::filesystem::path(source_folder()) / "fingers";
  auto viscous =
      nlohmann::json::parse(FingerModel::load(folder / "index-viscoelastic.toml")->as_read);
  const auto plain = nlohmann::json::parse(FingerModel::load(folder / "index.toml")->as_read);
  EXPECT_EQ(viscous["material"]["relaxation"].size(), 3u);
  viscous["material"].erase("relaxation");
  EXPECT_EQ(viscous, plain);
}

INSTANTIATE_TEST_SUITE_P(Sizes, ShippedFinger,
                         ::testing::Values(Expected{"index", 340, 480},
                                           // Layers are thin: 0.6 mm under elements of 4 mm.
                                           Expected{"index-layered", 1500, 2500, 5.0, false},
                                           Expected{"index-medium", 1200, 1400},
                                           Expected{"index-fine", 4000, 6500},
                                           Expected{"index-reference", 20000, 30000}),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace softfinger
