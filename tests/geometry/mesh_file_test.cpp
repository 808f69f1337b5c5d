#include "softfinger/geometry/mesh_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>

#include "generated_mesh.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/geometry/closed_surface.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
namespace fs = std::filesystem;

fs::path file_named(const std::string& name) {
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const fs::path folder = fs::path(testing::TempDir()) / ("mesh_" + test);
  fs::create_directories(folder);
  return folder / name;
}

std::string error_of(const fs::path& file) {
  try {
    (void)closed_surface(triangles_of(read_mesh_source(file), 1e-3), file.string());
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    EXPECT_THAT(error.what(), HasSubstr(file.string() + ": "));
    return error.what();
  }
  return "no error";
}

std::string error_of(const std::string& name, const std::string& content) {
  write_file(file_named(name), content);
  return error_of(file_named(name));
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Corners of all triangles, each beginning with its least corner, in order: what is left when
/// vertices are numbered differently.
std::vector<std::array<double, 9>> corners(const TriangleMesh& mesh) {
  std::vector<std::array<double, 9>> all;
  for (const auto& t : mesh.triangles) {
    std::array<std::array<double, 3>, 3> c;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3& p = mesh.positions[static_cast<std::size_t>(t[k])];
      c[k] = {p.x(), p.y(), p.z()};
    }
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    std::array<double, 9> flat;
    for (std::size_t k = 0; k < 9; ++k) flat[k] = c[k / 3][k % 3];
    all.push_back(flat);
  }
  std::ranges::sort(all);
  return all;
}

TEST(MeshFile, AllFormatsGiveTheSameMesh) {
  const TriangleMesh mesh = torus_mesh(0.02, 0.008, 24, 12);
  std::vector<std::vector<std::array<double, 9>>> read;
  for (const char* name : {"a.obj", "a.stl", "a.ply", "a.GLB", "a.gltf"}) {
    const fs::path file = file_named(name);
    const double unit = std::string(name).find(".g") == std::string::npos &&
                                std::string(name).find(".G") == std::string::npos
                            ? 1e-3
                            : 1.0;
    write_mesh(file, mesh, unit);
    const TriangleMesh got = triangles_of(read_mesh_source(file), unit);
    EXPECT_EQ(got.positions.size(), mesh.positions.size()) << name;
    read.push_back(corners(got));
  }
  for (const auto& other : read) {
    ASSERT_EQ(other.size(), mesh.triangles.size());
    for (std::size_t i = 0; i < other.size(); ++i) {
      for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(other[i][k], read[0][i][k], 5e-9);
    }
  }
}

TEST(MeshFile, TextStl) {
  const TriangleMesh mesh = box_mesh({0.01, 0.01, 0.01});
  std::string text = "solid box\n";
  for (const auto& t : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int vertex : t) {
      const Vector3& p = mesh.positions[static_cast<std::size_t>(vertex)];
      text += fmt::format("vertex {} {} {}\n", p.x() * 1e3, p.y() * 1e3, p.z() * 1e3);
    }
    text += "endloop\nendfacet\n";
  }
  EXPECT_EQ(error_of("box.stl", text + "endsolid box\n"), "no error");
}

TEST(MeshFile, JoinsMeshesWithTheTransformsOfTheirNodes) {
  const TriangleMesh mesh = box_mesh({0.01, 0.01, 0.01});
  const fs::path file = file_named("two.gltf");
  write_mesh(file, mesh, 1.0);
  std::string text = content_of(file);
  const std::string nodes = R"("nodes":[0]}],"nodes":[{"mesh":0}])";
  const std::string two =
      R"("nodes":[0,1]}],"nodes":[{"mesh":0},)"
      R"({"children":[2],"translation":[0.1,0,0]},{"mesh":0,"scale":[-2,1,1]}])";
  ASSERT_NE(text.find(nodes), std::string::npos);
  text.replace(text.find(nodes), nodes.size(), two);
  write_file(file, text);
  const ClosedSurface surface = closed_surface(triangles_of(read_mesh_source(file), 1.0), "two");
  ASSERT_EQ(surface.part_volume.size(), 2u);
  EXPECT_NEAR(surface.part_volume[0], 8e-6, 1e-11);
  EXPECT_NEAR(surface.part_volume[1], 16e-6, 1e-11);  // mirrored, not inside out
  double right = 0.0;
  for (const Vector3& p : surface.mesh.positions) right = std::max(right, p.x());
  EXPECT_NEAR(right, 0.12, 1e-7);
}

TEST(MeshFile, BufferBesideAGltfFileBelongsToIt) {
  const TriangleMesh mesh = box_mesh({0.01, 0.01, 0.01});
  fs::remove(file_named("the buffer.bin"));  // of an earlier run
  write_mesh(file_named("box.gltf"), mesh, 1.0);
  write_mesh(file_named("box.glb"), mesh, 1.0);
  const std::string glb = content_of(file_named("box.glb"));
  std::uint32_t json_size = 0;
  std::memcpy(&json_size, glb.data() + 12, 4);
  const std::string buffer = glb.substr(20 + json_size + 8);
  std::string text = content_of(file_named("box.gltf"));
  const std::size_t begin = text.find("data:");
  text.replace(begin, text.find('"', begin) - begin, "the%20buffer.bin");
  write_file(file_named("box.gltf"), text);
  EXPECT_THAT(error_of(file_named("missing.gltf")), EndsWith("no such file"));
  try {
    (void)read_mesh_source(file_named("box.gltf"));
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), EndsWith("the buffer.bin: no such file"));
  }
  write_file(file_named("the buffer.bin"), buffer);
  EXPECT_EQ(error_of(file_named("box.gltf")), "no error");
  const std::uint64_t hash = read_mesh_source(file_named("box.gltf")).hash;
  std::string other = buffer;
  other[5] = static_cast<char>(other[5] ^ 1);
  write_file(file_named("the buffer.bin"), other);
  EXPECT_NE(read_mesh_source(file_named("box.gltf")).hash, hash);
  text.replace(text.find("the%20buffer.bin"), 16, "../../../etc/pass");
  EXPECT_THAT(error_of("box.gltf", text), HasSubstr("names a buffer that is not in its folder"));
}

TEST(MeshFile, RefusesByName) {
  EXPECT_THAT(error_of(file_named("none.obj")), EndsWith("no such file"));
  EXPECT_THAT(error_of("part.step", "x"), HasSubstr("expected .obj, .stl, .ply, .gltf or .glb"));
  for (const char* name : {"e.obj", "e.stl", "e.ply", "e.gltf", "e.glb"}) {
    EXPECT_THAT(error_of(name, ""), EndsWith("is empty")) << name;
    EXPECT_NE(error_of(name,
                       "nonsense and more of it, until there is enough of it for every header "
                       "that anyone may think of, or so"),
              "no error")
        << name;
  }
  EXPECT_THAT(error_of("points.obj", "v 1 2 3\nv 1 2 4\n"), testing::Ne("no error"));
  EXPECT_THAT(error_of("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("not finite"));
  EXPECT_THAT(error_of("inf.obj", "v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("not finite"));
  EXPECT_THAT(error_of("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("open"));
  fs::create_directories(file_named("folder.stl"));
  EXPECT_THAT(error_of(file_named("folder.stl")), HasSubstr("is a directory"));
}

TEST(MeshFile, ReadingThatDoesNotEndIsEnded) {
  EXPECT_THAT(error_of("endless.ply", "ply\nformat ascii 1.0\nend_headerJ0 0 0"),
              HasSubstr("is broken: reading it as PLY failed"));
}

TEST(MeshFile, RefusesHeadersThatAnnounceMoreThanThereIs) {
  write_mesh(file_named("a.stl"), box_mesh({0.01, 0.01, 0.01}), 1e-3);
  std::string stl = content_of(file_named("a.stl"));
  stl.replace(80, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(error_of("a.stl", stl),
              AllOf(HasSubstr("announces 4294967295 triangles"), HasSubstr("it has 684 bytes")));
  EXPECT_THAT(error_of("b.ply",
                       "ply\nformat ascii 1.0\nelement vertex 999999999999\nproperty float "
                       "x\nend_header\n0\n"),
              HasSubstr("PLY"));
  EXPECT_THAT(error_of("c.ply",
                       "ply\nformat ascii 1.0\nelement vertex 1000000\nproperty float "
                       "x\nend_header\n0\n"),
              HasSubstr("announces 1000000 elements"));
  write_mesh(file_named("d.glb"), box_mesh({0.01, 0.01, 0.01}), 1.0);
  std::string glb = content_of(file_named("d.glb"));
  glb.replace(12, 4, "\xf0\xff\xff\xff");
  EXPECT_THAT(error_of("d.glb", glb), HasSubstr("announces 4294967280 bytes"));
  write_mesh(file_named("e.gltf"), box_mesh({0.01, 0.01, 0.01}), 1.0);
  std::string gltf = content_of(file_named("e.gltf"));
  gltf.replace(gltf.find("\"count\":"), 9, "\"count\":1099511627776");
  EXPECT_THAT(error_of("e.gltf", gltf), HasSubstr("announces count of 1099511627776"));
}

}  // namespace
}  // namespace softfinger
