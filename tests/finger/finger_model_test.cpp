#include "softfinger/finger/finger_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

/// Two tetrahedra on a common face 2 3 4: the upper has its top face on the bone, the lower's tip
/// is skin. mm.
struct MeshText {
  std::string names = "3\n2 1 \"skin\"\n2 2 \"bone\"\n3 1 \"tissue\"\n";
  std::vector<std::string> nodes{"1 0 0 4", "2 4 0 0", "3 -2 3 0", "4 -2 -3 0", "5 0 0 -4"};
  std::vector<std::string> elements{"1 2 2 1 1 5 3 2", "2 2 2 1 1 5 4 3",   "3 2 2 1 1 5 2 4",
                                    "4 2 2 2 2 1 2 3", "5 4 2 1 1 2 3 4 1", "6 4 2 1 1 2 4 3 5"};
  [[nodiscard]] std::string text() const {
    std::string result = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n" + names +
                         "$EndPhysicalNames\n$Nodes\n" + std::to_string(nodes.size()) + "\n";
    for (const std::string& node : nodes) result += node + "\n";
    result += "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
    for (const std::string& element : elements) result += element + "\n";
    return result + "$EndElements\n";
  }
};

class FingerModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    directory_ =
        std::filesystem::path(::testing::TempDir()) /
        ("finger_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::shared_ptr<const FingerModel> load(const std::string& toml, const MeshText& mesh = {}) {
    std::ofstream(directory_ / "tip.msh") << mesh.text();
    std::ofstream(directory_ / "tip.toml") << "[mesh]\nfile = 'tip.msh'\n" << toml;
    return FingerModel::load(directory_ / "tip.toml");
  }
  /// The one line of a refusal without the directory.
  std::string error(const std::string& toml, const MeshText& mesh = {}) {
    try {
      load(toml, mesh);
    } catch (const InputError& thrown) {
      const std::string message = thrown.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(message.rfind(directory_.string() + "/", 0), 0u) << message;
      return message.substr(directory_.string().size() + 1);
    }
    ADD_FAILURE() << "nothing thrown for:\n" << toml;
    return {};
  }

  std::filesystem::path directory_;
};

TEST_F(FingerModelTest, GroupsOfTheMesh) {
  const auto model = load("");
  EXPECT_THAT(model->sample_nodes, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(model->node_is_rigid, ElementsAre(true, true, true, false, false));
  EXPECT_EQ(model->skin_triangles.size(), 3u);
  double area = 0.0;
  for (const auto& triangle : model->skin_triangles) {
    std::array<Vector3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const int node = model->sample_nodes[static_cast<std::size_t>(triangle[k])];
      p[k] = model->mesh.nodes[static_cast<std::size_t>(node)];
    }
    const Vector3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    EXPECT_LT(normal.z(), 0.0) << "outward is down here";
    area += 0.5 * normal.norm();
  }
  EXPECT_NEAR(
      std::accumulate(model->sample_rest_areas.begin(), model->sample_rest_areas.end(), 0.0), area,
      1e-15);
  EXPECT_NEAR(area, 0.5e-6 * (Vector3(24, 0, 12).norm() + 2.0 * Vector3(12, 24, 12).norm()), 1e-12);
}

TEST_F(FingerModelTest, DefaultsAndUnits) {
  const auto model = load("[material]\nyoungs_modulus_kPa = 60\n[bone]\nmass_g = 12\n");
  EXPECT_EQ(model->mesh.nodes[0], Vector3(0.0, 0.0, 4e-3));
  ASSERT_EQ(model->materials.size(), 1u);
  EXPECT_EQ(model->materials[0].volume, "tissue");
  EXPECT_DOUBLE_EQ(model->materials[0].youngs_modulus, 60e3);
  EXPECT_DOUBLE_EQ(model->materials[0].density, 1000.0);
  EXPECT_DOUBLE_EQ(model->bone_mass, 0.012);
  EXPECT_DOUBLE_EQ(model->coupling.rotation_stiffness, 0.2);
  EXPECT_EQ(model->strain_limits.stiffness, 0.0);
  const auto json = nlohmann::json::parse(model->as_read);
  EXPECT_EQ(json["mesh"]["file"], "tip.msh");
  EXPECT_EQ(json["mesh"]["unit"], "mm");
  EXPECT_EQ(json["material"]["poissons_ratio"], 0.4);
  EXPECT_EQ(json["contact"]["tolerance_mm"], 0.05);
  EXPECT_EQ(json["coupling"]["rotation_N_mm_s_per_rad"], 2.0);
  EXPECT_FALSE(json.contains("strain_limits"));
  EXPECT_FALSE(json.contains("size"));
}

TEST_F(FingerModelTest, MaterialsByVolume) {
  MeshText mesh;
  mesh.names = "4\n2 1 \"skin\"\n2 2 \"bone\"\n3 1 \"fat\"\n3 2 \"dermis\"\n";
  mesh.elements[5] = "6 4 2 2 1 2 4 3 5";
  const auto model = load(
      "[material]\nyoungs_modulus_kPa = 45\npoissons_ratio = 0.3\n"
      "[material.dermis]\nyoungs_modulus_kPa = 80\n",
      mesh);
  EXPECT_THAT(model->tetrahedron_material, ElementsAre(0, 1));
  ASSERT_EQ(model->materials.size(), 2u);
  EXPECT_DOUBLE_EQ(model->materials[0].youngs_modulus, 45e3);
  EXPECT_DOUBLE_EQ(model->materials[1].youngs_modulus, 80e3);
  EXPECT_DOUBLE_EQ(model->materials[1].poissons_ratio, 0.3);
  EXPECT_EQ(nlohmann::json::parse(model->as_read)["material"]["dermis"]["youngs_modulus_kPa"], 80);
  EXPECT_EQ(error("[material.dermsi]\n", mesh),
            "tip.toml:3: material.dermsi: the mesh has no physical volume of this name; it has: "
            "fat, dermis");
  EXPECT_THAT(error("[material]\nyoung_modulus_kPa = 3\n", mesh),
              HasSubstr("unknown key 'young_modulus_kPa'; did you mean 'youngs_modulus_kPa'?"));
}

TEST_F(FingerModelTest, EachOfSeveralVolumesNeedsConstants) {
  MeshText mesh;
  mesh.names = "4\n2 1 \"skin\"\n2 2 \"bone\"\n3 1 \"fat\"\n3 2 \"dermis\"\n";
  mesh.elements[5] = "6 4 2 2 1 2 4 3 5";
  const std::string fat = "[material.fat]\nyoungs_modulus_kPa = 30\npoissons_ratio = 0.4\n";
  EXPECT_EQ(error("", mesh),
            "tip.toml:2: mesh.file: tip.msh has several physical volumes, fat, dermis: give each "
            "its constants in [material.NAME], or all of them in [material]");
  EXPECT_EQ(error("[material]\nyoungs_modulus_kPa = 30\n" + fat, mesh),
            "tip.toml:3: material.dermis: missing; one of several physical volumes of the mesh, it "
            "needs poissons_ratio here or in [material]");
  EXPECT_THAT(error(fat, mesh), HasSubstr("material.dermis: missing; one of several physical "
                                          "volumes of the mesh, it needs youngs_modulus_kPa"));
  EXPECT_THAT(error(fat + "[material.dermis]\nyoungs_modulus_kPa = 80\n", mesh),
              HasSubstr("tip.toml:6: material.dermis.poissons_ratio: missing"));
  EXPECT_THAT(
      error(fat + "[material.dermis]\nyoungs_modulus_kPa = 80\npoissons_ratio = 0.5\n", mesh),
      HasSubstr("tip.toml:8: material.dermis.poissons_ratio: must be at least 0 and less "
                "than 0.5, found 0.5"));
  EXPECT_THAT(error("[material]\nyoung_modulus_kPa = 3\n", mesh),
              HasSubstr("did you mean 'youngs_modulus_kPa'?"));
  const auto model =
      load(fat + "[material.dermis]\nyoungs_modulus_kPa = 80\npoissons_ratio = 0.45\n", mesh);
  EXPECT_DOUBLE_EQ(model->materials[0].youngs_modulus, 30e3);
  EXPECT_DOUBLE_EQ(model->materials[1].poissons_ratio, 0.45);
  EXPECT_DOUBLE_EQ(model->materials[1].density, 1000.0);
  // What no volume has is not told as if it had a meaning.
  EXPECT_FALSE(nlohmann::json::parse(model->as_read)["material"].contains("youngs_modulus_kPa"));
}

TEST_F(FingerModelTest, Relaxation) {
  const std::string term = "[[material.relaxation]]\ntime_ms = 70\nfraction = 0.6\n";
  const auto model = load(term);
  ASSERT_EQ(model->relaxation.terms.size(), 1u);
  EXPECT_DOUBLE_EQ(model->relaxation.terms[0].time, 70e-3);
  EXPECT_DOUBLE_EQ(model->relaxation.long_time_fraction(), 0.4);
  EXPECT_THAT(error(term + term), HasSubstr("tip.toml:8: material.relaxation[1].fraction: the "
                                            "fractions of all [[material.relaxation]] must sum"));
  EXPECT_THAT(error("[[material.relaxation]]\ntime_ms = 0\nfraction = 0.6\n"),
              HasSubstr("time_ms: must be"));
  EXPECT_THAT(error("[[material.relaxation]]\ntime_ms = 4\nfraction = 0\n"),
              HasSubstr("fraction: must be"));
}

TEST_F(FingerModelTest, VolumeNamedBoneIsRigid) {
  MeshText mesh;
  mesh.names = "3\n2 1 \"skin\"\n3 1 \"tissue\"\n3 2 \"bone\"\n";
  mesh.elements[4] = "5 4 2 2 1 2 3 4 1";
  mesh.elements.erase(mesh.elements.begin() + 3);
  const auto model = load("", mesh);
  EXPECT_THAT(model->node_is_rigid, ElementsAre(true, true, true, true, false));
  EXPECT_THAT(model->tetrahedron_material, ElementsAre(-1, 0));
  EXPECT_THAT(error("[material.bone]\n", mesh), HasSubstr("the volume 'bone' is rigid"));
}

TEST_F(FingerModelTest, NailIsRigid) {
  MeshText mesh;
  mesh.names = "4\n2 1 \"skin\"\n2 2 \"bone\"\n2 3 \"nail\"\n3 1 \"tissue\"\n";
  mesh.elements.push_back("7 2 2 3 1 1 4 3");
  const auto model = load("", mesh);
  EXPECT_THAT(model->node_is_rigid, ElementsAre(true, true, true, true, false));
}

TEST_F(FingerModelTest, StrainLimits) {
  const std::string head = "[strain_limits]\nmin = 0.7\nmax = 1.3\nstiffness_kPa = 20\n";
  const auto model = load(head + "width = 0.3\n");
  EXPECT_DOUBLE_EQ(model->strain_limits.stiffness, 20e3);
  EXPECT_EQ(error(head + "width = 0.31\n"),
            "tip.toml:7: strain_limits.width: must be at most 0.3, the lesser of 1 - min and max - "
            "1, else the skin is stressed at rest; found 0.31");
  EXPECT_THAT(error("[strain_limits]\nmin = 1.2\n"), HasSubstr("less than 1, found 1.2"));
  EXPECT_THAT(error("[strain_limits]\nmax = 0.9\n"), HasSubstr("greater than 1"));
}

TEST_F(FingerModelTest, SizeScalesTheSkin) {
  const auto model = load("[size]\nlength_mm = 12\ndepth_mm = 2\n");
  Eigen::AlignedBox3d box;
  for (const int node : model->sample_nodes) {
    box.extend(model->mesh.nodes[static_cast<std::size_t>(node)]);
  }
  EXPECT_TRUE(box.sizes().isApprox(Vector3(12e-3, 6e-3, 2e-3), 1e-12));
  EXPECT_TRUE(model->mesh.nodes[0].isApprox(Vector3(0.0, 0.0, 2e-3), 1e-12));
  const auto plain = load("");
  const auto wide = load("[size]\nlength_mm = 12\nbreadth_mm = 12\n");
  for (std::size_t i = 0; i < plain->sample_nodes.size(); ++i) {
    EXPECT_GT(wide->sample_rest_areas[i], 2.0 * plain->sample_rest_areas[i]);
    EXPECT_LT(wide->sample_rest_areas[i], 4.0 * plain->sample_rest_areas[i]);
  }
}

TEST_F(FingerModelTest, RefusesConstantsOutOfRange) {
  EXPECT_EQ(error("[material]\nyoungs_modulus_kPa = -1\n"),
            "tip.toml:4: material.youngs_modulus_kPa: must be greater than 0, found -1");
  EXPECT_THAT(error("[material]\npoissons_ratio = 0.5\n"), HasSubstr("less than 0.5, found 0.5"));
  EXPECT_THAT(error("[material]\ndensity_kg_per_m3 = nan\n"), HasSubstr("finite"));
  EXPECT_THAT(error("[bone]\nmass_g = 0\n"), HasSubstr("bone.mass_g: must be greater than 0"));
  EXPECT_THAT(error("[coupling]\nrotation_N_mm_per_rad = 0\n"), HasSubstr("greater than 0"));
  EXPECT_THAT(error("[contact]\nfriction_coefficient = -0.1\n"), HasSubstr("at least 0"));
  EXPECT_THAT(error("[size]\nlength_mm = 0\n"), HasSubstr("size.length_mm: must be at least 1"));
  EXPECT_THAT(error("[contact]\ntolerance_cm = 1\n"), HasSubstr("did you mean 'tolerance_mm'?"));
  EXPECT_THAT(error("[colour]\n"), HasSubstr("unknown key 'colour'"));
}

TEST_F(FingerModelTest, RefusesMeshInTheWrongUnit) {
  EXPECT_THAT(error("unit = 'm'\n"), HasSubstr("tip.toml:3: mesh.unit: the mesh is 8e+03 mm long"));
  EXPECT_THAT(error("unit = 'cm'\n"), HasSubstr("expected one of: mm, m"));
}

TEST_F(FingerModelTest, RefusesMeshesThatAreNoFinger) {
  MeshText mesh;
  mesh.names = "2\n2 1 \"Skin\"\n2 2 \"bone\"\n";
  EXPECT_EQ(error("", mesh),
            "tip.toml:2: mesh.file: tip.msh: the mesh has no physical surface 'skin'; it has: "
            "Skin, bone");
  mesh.names = "2\n2 1 \"skin\"\n2 2 \"bones\"\n";
  EXPECT_THAT(error("", mesh),
              HasSubstr("no physical surface or volume 'bone'; it has: skin, bones"));
  mesh = {};
  mesh.elements[0] = "1 2 2 1 1 2 3 4";
  EXPECT_THAT(error("", mesh), HasSubstr("triangles of group 'skin' inside"));
  mesh = {};
  mesh.nodes.insert(mesh.nodes.end(), {"6 0 0 9", "7 4 0 9", "8 0 4 9", "9 0 0 14"});
  mesh.elements.insert(mesh.elements.end(), {"7 4 2 1 1 6 7 8 9"});
  EXPECT_THAT(error("", mesh), HasSubstr("tissue that is not connected to bone"));
  mesh.elements.push_back("8 2 2 1 1 6 7 8");
  EXPECT_THAT(error("", mesh), HasSubstr("skin that is not connected to bone by tissue"));
  mesh = {};
  mesh.elements.push_back("7 2 2 2 2 1 3 4");
  mesh.elements.push_back("8 2 2 2 2 5 2 4");
  EXPECT_THAT(error("", mesh), HasSubstr("no node that is free to move"));
}

TEST_F(FingerModelTest, MeshErrorsNameTheMeshFile) {
  MeshText mesh;
  mesh.elements[4] = "5 4 2 1 1 3 2 4 1";
  EXPECT_THAT(error("", mesh), HasSubstr("tip.msh:24: tetrahedron 5 is inverted"));
  std::ofstream(directory_ / "alone.toml") << "[mesh]\nfile = 'absent.msh'\n";
  EXPECT_THROW((void)FingerModel::load(directory_ / "alone.toml"), InputError);
  std::ofstream(directory_ / "none.toml") << "[material]\n";
  EXPECT_THROW((void)FingerModel::load(directory_ / "none.toml"), InputError);
}

}  // namespace
}  // namespace softfinger
