#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <variant>

#include "softfinger/base/error.hpp"
#include "softfinger/geometry/signed_distance_grid.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// Twelve triangles of a cube of edge 10, in a folder of the test's own.
fs::path folder_with_cube() {
  const fs::path folder =
      fs::path(testing::TempDir()) /
      (std::string("mesh_object_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::ofstream(folder / "cube.obj")
      << "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 0 0 10\nv 10 0 10\nv 10 10 10\nv 0 10 10\n"
         "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  return folder;
}

std::string scene_with(const std::string& objects) {
  return "[[finger]]\nname = \"index\"\nmodel = \"index.toml\"\n[[finger.waypoint]]\ntime_s = 0.0\n"
         "position_mm = [0, 0, 40]\n" +
         objects;
}

Scene load(const fs::path& folder, const std::string& objects) {
  std::ofstream(folder / "scene.toml") << scene_with(objects);
  return load_scene(folder / "scene.toml");
}

std::string error_of(const fs::path& folder, const std::string& objects) {
  try {
    (void)load(folder, objects);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

const std::string kCube = "[[object]]\nshape = \"mesh\"\nfile = \"cube.obj\"\n";

TEST(MeshObject, IsReadInItsUnitBesideTheScene) {
  const fs::path folder = folder_with_cube();
  const struct {
    const char* name;
    double metres;
    const char* rounding_mm;
  } units[] = {{"mm", 1e-3, "2"}, {"cm", 1e-2, "10"}, {"inch", 25.4e-3, "10"}};
  for (const auto& unit : units) {
    const Scene scene = load(folder, kCube + "edge_rounding_mm = " + unit.rounding_mm +
                                         "\nunit = \"" + unit.name + "\"\n");
    const auto& mesh = std::get<MeshShape>(scene.objects.at(0).shape);
    EXPECT_NEAR(mesh->content().bounds.max().x(), 10.0 * unit.metres, 1e-9) << unit.name;
    EXPECT_EQ(scene.objects[0].name, "mesh");
    EXPECT_EQ(mesh->content().triangle_count, 12u);
    const Vector3 above(5.0 * unit.metres, 5.0 * unit.metres, 10.0 * unit.metres + 1e-3);
    EXPECT_NEAR(signed_distance(scene.objects[0].shape, above).distance, 1e-3, 1e-6) << unit.name;
  }
}

TEST(MeshObject, ObjectsOfTheSameFileShareItsGrid) {
  const std::string cube = kCube + "unit = \"mm\"\nedge_rounding_mm = 1\n";
  const Scene scene = load(folder_with_cube(), cube + "name = \"a\"\n" + cube + "name = \"b\"\n");
  EXPECT_EQ(std::get<MeshShape>(scene.objects.at(0).shape),
            std::get<MeshShape>(scene.objects.at(1).shape));
}

TEST(MeshObject, RefusesWithFileLineAndKey) {
  const fs::path folder = folder_with_cube();
  EXPECT_THAT(error_of(folder, kCube), AllOf(HasSubstr("scene.toml:"), HasSubstr("unit")));
  EXPECT_THAT(error_of(folder, kCube + "unit = \"feet\"\n"),
              AllOf(HasSubstr("scene.toml:10: object[0].unit"), HasSubstr("inch")));
  EXPECT_THAT(error_of(folder, kCube + "unit = \"mm\"\nedge_rounding_mm = 0.0\n"),
              HasSubstr("edge_rounding_mm"));
  EXPECT_THAT(error_of(folder, kCube + "edge_rounding_mm = 2\nunit = \"mm\"\nradius_mm = 3.0\n"),
              HasSubstr("radius_mm"));
  EXPECT_THAT(error_of(folder, "[[object]]\nshape = \"mesh\"\nunit = \"mm\"\n"), HasSubstr("file"));
  EXPECT_THAT(
      error_of(folder, "[[object]]\nshape = \"mesh\"\nfile = \"none.stl\"\nunit = \"mm\"\n"),
      AllOf(HasSubstr("scene.toml:9: object[0].file"), HasSubstr("none.stl: no such file")));
  EXPECT_THAT(error_of(folder, "[[object]]\nshape = \"mesh\"\nfile = \"a.step\"\nunit = \"mm\"\n"),
              HasSubstr("expected .obj"));
  EXPECT_THAT(error_of(folder, "[[object]]\nshape = \"mesh\"\nfile = \"a.glb\"\nunit = \"mm\"\n"),
              HasSubstr("scene.toml:10: object[0].unit: unknown value 'mm'; did you mean 'm'"));
  EXPECT_THAT(error_of(folder, kCube + "unit = \"m\"\n"), HasSubstr("too large"));
}

TEST(MeshObject, MovesByForcesWithTheMassOfItsVolume) {
  const fs::path folder = folder_with_cube();
  const std::string moves = kCube + "unit = \"mm\"\nedge_rounding_mm = 1\nmotion = \"dynamic\"\n";
  const Scene scene = load(folder, moves + "density_kg_per_m3 = 1000\n");
  // A cube of 1 cm^3, as its grid has it.
  EXPECT_NEAR(scene.objects.at(0).dynamics->mass, 1e-3, 0.03e-3);
  EXPECT_EQ(load(folder, moves + "mass_g = 5\n").objects.at(0).dynamics->mass, 5e-3);
  std::ofstream(folder / "cube.obj") << "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\n";
  EXPECT_THAT(error_of(folder, moves + "mass_g = 5\n"),
              AllOf(HasSubstr("object[0].file"), HasSubstr("open")));
}

TEST(MeshObject, SpellingIsCheckedBeforeTheMeshIsLoaded) {
  const std::string error =
      error_of(folder_with_cube(),
               "[[object]]\nshape = \"mesh\"\nfile = \"none.stl\"\nunit = \"mm\"\nfriktion = 1\n");
  EXPECT_THAT(error, HasSubstr("friktion"));
}

}  // namespace
}  // namespace softfinger
