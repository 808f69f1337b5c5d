// Soft objects of a scene file: tetrahedra, material, and what they are refused for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "softfinger/base/error.hpp"
#include "softfinger/finger/soft_solid.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kMaterial =
    "[object.material]\nyoungs_modulus_kPa = 20\npoissons_ratio = 0.3\ndensity_kg_per_m3 = 200\n";

/// A tetrahedron with edges of 20 mm and, `pieces` times, more of them further along x.
std::string tetrahedra(int pieces, const std::string& surface, bool held) {
  std::string nodes;
  std::string elements;
  int count = 0;
  for (int p = 0; p < pieces; ++p) {
    const std::string x = std::to_string(30 * p);
    const std::string far = std::to_string(30 * p + 20);
    const int n = 4 * p;
    nodes += std::to_string(n + 1) + " " + x + " 0 0\n" + std::to_string(n + 2) + " " + far +
             " 0 0\n" + std::to_string(n + 3) + " " + x + " 20 0\n" + std::to_string(n + 4) + " " +
             x + " 0 20\n";
    const auto element = [&](const std::string& kind, const std::string& group,
                             std::initializer_list<int> corners) {
      elements += std::to_string(++count) + " " + kind + " 2 " + group + " " + group;
      for (const int corner : corners) elements += " " + std::to_string(n + corner);
      elements += "\n";
    };
    element("2", "1", {2, 3, 4});
    if (held) element("2", "3", {1, 3, 2});
    element("4", "2", {1, 2, 3, 4});
  }
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"" + surface +
         "\"\n2 3 \"fixed\"\n3 2 \"foam\"\n$EndPhysicalNames\n$Nodes\n" +
         std::to_string(4 * pieces) + "\n" + nodes + "$EndNodes\n$Elements\n" +
         std::to_string(count) + "\n" + elements + "$EndElements\n";
}

class SoftObjectFile : public testing::Test {
 protected:
  SoftObjectFile() {
    std::filesystem::create_directories(folder_);
    put("foam.msh", tetrahedra(1, "surface", false));
    put("held.msh", tetrahedra(1, "surface", true));
  }
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// `keys` begin in line 3 of the file.
  [[nodiscard]] Scene load(const std::string& keys) const {
    put("scene.toml", "[[object]]\nshape = \"soft\"\n" + keys);
    return load_scene(folder_ / "scene.toml");
  }
  [[nodiscard]] std::string refusal_of(const std::string& keys) const {
    try {
      (void)load(keys);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("soft_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

const std::string kFoam = "file = \"foam.msh\"\nunit = \"mm\"\n";

TEST_F(SoftObjectFile, IsReadInSiAndHeavyByItsDensity) {
  const Scene scene = load(kFoam + "position_mm = [0, 0, 5]\n" + kMaterial);
  const VirtualObject& object = scene.objects.at(0);
  EXPECT_EQ(object.name, "soft");
  ASSERT_NE(object.soft, nullptr);
  EXPECT_FALSE(object.dynamics);
  EXPECT_TRUE(object.moves_by_forces());
  EXPECT_NEAR(object.soft->mass(), 200.0 * 8e-6 / 6.0, 1e-12);
  EXPECT_EQ(object.soft->materials.at(0).youngs_modulus, 20e3);
  EXPECT_EQ(object.soft->sample_nodes.size(), 3u);
  EXPECT_FALSE(object.soft->is_held());
  EXPECT_EQ(object.motion.sample(0.0).translation.z(), 5e-3);
}

TEST_F(SoftObjectFile, DensifiesUnlessItHasLimitsOfItsOwn) {
  const std::string keys = kFoam + kMaterial;
  const StrainLimit foam = load(keys).objects[0].soft->strain_limits;
  EXPECT_DOUBLE_EQ(foam.min, 0.1);
  EXPECT_DOUBLE_EQ(foam.stiffness, 20e3);
  const StrainLimit own =
      load(keys + "[object.strain_limits]\nmin = 0.5\n").objects[0].soft->strain_limits;
  EXPECT_DOUBLE_EQ(own.min, 0.5);
  EXPECT_DOUBLE_EQ(own.max, StrainLimit{}.max);
}

TEST_F(SoftObjectFile, WhatIsHeldMayFollowWaypoints) {
  const std::string way =
      "[[object.waypoint]]\ntime_s = 0\n[[object.waypoint]]\ntime_s = 1\nposition_mm = [9, 0, 0]\n";
  const Scene scene = load("file = \"held.msh\"\nunit = \"mm\"\n" + way + kMaterial);
  EXPECT_TRUE(scene.objects.at(0).soft->is_held());
  EXPECT_NEAR(scene.objects.at(0).motion.sample(1.0).translation.x(), 9e-3, 1e-12);
  EXPECT_THAT(refusal_of(kFoam + way + kMaterial), HasSubstr("no physical surface 'fixed'"));
}

TEST_F(SoftObjectFile, RefusesWithLineAndKey) {
  EXPECT_THAT(refusal_of(kFoam),
              AllOf(HasSubstr("scene.toml"), HasSubstr("material"), HasSubstr("missing")));
  EXPECT_THAT(refusal_of(kFoam + "[object.material]\npoissons_ratio = 0.3\n"),
              AllOf(HasSubstr("youngs_modulus_kPa"), HasSubstr("missing")));
  const auto material = [](const std::string& modulus, const std::string& density) {
    return kFoam + "[object.material]\nyoungs_modulus_kPa = " + modulus +
           "\npoissons_ratio = 0.3\ndensity_kg_per_m3 = " + density + "\n";
  };
  EXPECT_THAT(refusal_of(material("0.001", "200")),
              AllOf(HasSubstr(":6"), HasSubstr("youngs_modulus_kPa"), HasSubstr("0.5")));
  EXPECT_THAT(refusal_of(material("1e7", "200")), HasSubstr("100000"));
  EXPECT_THAT(refusal_of(material("20", "1")), AllOf(HasSubstr(":8"), HasSubstr("density")));
  EXPECT_THAT(refusal_of(material("20", "200") + "[object.material.foam]\ndensity_kg_per_m3 = 1\n"),
              AllOf(HasSubstr(":10"), HasSubstr("density_kg_per_m3"), HasSubstr("found 1")));
  EXPECT_THAT(refusal_of(kFoam + "mass_g = 5\n" + kMaterial),
              AllOf(HasSubstr(":5"), HasSubstr("mass_g"), HasSubstr("density")));
  EXPECT_THAT(refusal_of("file = \"foam.stl\"\nunit = \"mm\"\n" + std::string(kMaterial)),
              AllOf(HasSubstr(":3"), HasSubstr("file")));
  EXPECT_THAT(refusal_of("file = \"none.msh\"\nunit = \"mm\"\n" + std::string(kMaterial)),
              AllOf(HasSubstr(":3"), HasSubstr("none.msh")));
  EXPECT_THAT(refusal_of("file = \"foam.msh\"\nunit = \"m\"\n" + std::string(kMaterial)),
              AllOf(HasSubstr(":4"), HasSubstr("unit"), HasSubstr("20000 mm long")));
  EXPECT_THAT(refusal_of(kFoam + "youngs = 3\n" + kMaterial), HasSubstr("youngs"));
}

TEST_F(SoftObjectFile, RefusesMeshesThatAreNoSoftObject) {
  const std::string keys = "file = \"bad.msh\"\nunit = \"mm\"\n" + std::string(kMaterial);
  put("bad.msh", tetrahedra(1, "outside", false));
  EXPECT_THAT(refusal_of(keys), HasSubstr("no physical surface 'surface'"));
  put("bad.msh", tetrahedra(2, "surface", false));
  EXPECT_THAT(refusal_of(keys), HasSubstr("several pieces"));
}

TEST_F(SoftObjectFile, NothingHangsOnIt) {
  const std::string door =
      "[[object]]\nshape = \"box\"\nsize_mm = [9, 9, 9]\nmotion = \"dynamic\"\nmass_g = 9\n"
      "[object.joint]\nkind = \"fixed\"\nparent = \"soft\"\n";
  EXPECT_THAT(refusal_of("name = \"soft\"\n" + kFoam + kMaterial + door),
              AllOf(HasSubstr("parent"), HasSubstr("is soft")));
}

}  // namespace
}  // namespace softfinger
