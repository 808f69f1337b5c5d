#include "softfinger/geometry/mesh_shape.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "../support/environment_variable.hpp"
#include "generated_mesh.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/geometry/grid_cache.hpp"
#include "softfinger/geometry/mesh_drawing.hpp"
#include "softfinger/geometry/mesh_file.hpp"
#include "softfinger/geometry/triangle_tree.hpp"
#include "softfinger/geometry/vertex_weld.hpp"

namespace softfinger {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// A folder of the test's own, empty, with a sphere of radius 5 mm in it.
class MeshShapeFile : public testing::Test {
 protected:
  MeshShapeFile()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("shape_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())),
        file_(folder_ / "ball.obj") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write_mesh(file_, sphere_mesh(0.005, 10), 1e-3);
  }

  std::vector<fs::path> kept() const {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder_ / ".softfinger-cache", error)) {
      files.push_back(entry.path());
    }
    return files;
  }
  /// Loads, and says whether the grid had to be built.
  bool builds() {
    bool built = false;
    shape_ = load_mesh_shape(file_, {.edge_rounding = kRounding},
                             {.progress = [&](double) { built = true; }, .message = {}});
    return built;
  }
  std::vector<double> distances() const {
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> x(-0.012, 0.012);
    std::vector<double> all;
    for (int i = 0; i < 1000; ++i) {
      const SignedDistance at =
          signed_distance(Shape(shape_), {x(generator), x(generator), x(generator)});
      all.insert(all.end(), {at.distance, at.gradient.x(), at.hessian(0, 1)});
    }
    return all;
  }

  static constexpr double kRounding = 1e-3;
  fs::path folder_;
  fs::path file_;
  MeshShape shape_;
};

// Wherever the end is asked for, the last thing before the cache is written included.
TEST_F(MeshShapeFile, EndsWhenNobodyWantsItAndLeavesNothing) {
  for (const double end : {0.0, 0.15, 0.5, 1.0}) {
    std::stop_source source;
    const LoadObserver observer{.progress =
                                    [&](double fraction) {
                                      if (fraction >= end) source.request_stop();
                                    },
                                .message = {},
                                .stop = source.get_token()};
    EXPECT_THROW(static_cast<void>(load_mesh_shape(file_, {.edge_rounding = kRounding}, observer)),
                 InputError)
        << end;
    EXPECT_TRUE(kept().empty()) << end;
  }
  EXPECT_TRUE(builds());
  ASSERT_EQ(kept().size(), 1U);
  std::stop_source source;
  source.request_stop();
  const GridKey key{read_mesh_source(file_).hash, 1e-3, 0.5 * kRounding, 6e-3};
  EXPECT_TRUE(read_grid_cache(kept()[0], key));
  EXPECT_THROW(static_cast<void>(read_grid_cache(kept()[0], key, source.get_token())), InputError);
}

// What takes seconds for millions of triangles.
TEST(MeshWork, EndsWhenNobodyWantsIt) {
  const TriangleMesh mesh = torus_mesh(0.02, 0.008, 120, 60);
  const ClosedSurface surface = closed_surface(mesh, "torus");
  std::stop_source source;
  source.request_stop();
  const std::stop_token stop = source.get_token();
  EXPECT_THROW(static_cast<void>(welded(mesh, 1e-9, stop)), InputError);
  EXPECT_THROW(static_cast<void>(closed_surface(mesh, "torus", stop)), InputError);
  EXPECT_THROW(TriangleTree(surface, stop), InputError);
  EXPECT_THROW(static_cast<void>(drawing_of(mesh, 100, stop)), InputError);
}

TEST_F(MeshShapeFile, IsBuiltOnceAndKeptBitForBit) {
  EXPECT_TRUE(builds());
  const std::vector<double> fresh = distances();
  ASSERT_EQ(kept().size(), 1u);
  EXPECT_FALSE(builds());
  EXPECT_EQ(distances(), fresh);
  EXPECT_EQ(shape_->content().triangle_count, 2000u);
  EXPECT_EQ(shape_->content().drawing.triangles.size(), 2000u);
}

TEST_F(MeshShapeFile, AnotherContentUnitOrRoundingIsAnotherGrid) {
  EXPECT_TRUE(builds());
  const double before = shape_->signed_distance({0, 0, 0.008}).distance;
  write_mesh(file_, sphere_mesh(0.006, 10), 1e-3);
  EXPECT_TRUE(builds());
  EXPECT_NEAR(shape_->signed_distance({0, 0, 0.008}).distance, before - 0.001, 2e-5);
  const MeshShape finer = load_mesh_shape(file_, {.edge_rounding = 0.7e-3});
  EXPECT_EQ(kept().size(), 3u);
  const MeshShape inches = load_mesh_shape(file_, {.unit = 2e-3, .edge_rounding = kRounding});
  EXPECT_EQ(kept().size(), 4u);
  EXPECT_NEAR(inches->content().bounds.max().z(), 0.012, 2e-5);
}

TEST_F(MeshShapeFile, DamagedCacheIsBuiltAnew) {
  EXPECT_TRUE(builds());
  const std::vector<double> fresh = distances();
  const fs::path cache = kept().at(0);
  std::string bytes;
  {
    std::ifstream stream(cache, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(stream), {});
  }
  std::mt19937 generator(3);
  const auto damaged = [&](const std::string& content) {
    write_file(cache, content);
    const bool built = builds();
    EXPECT_EQ(distances(), fresh);
    return built;
  };
  EXPECT_FALSE(damaged(bytes));
  EXPECT_TRUE(damaged(""));
  EXPECT_TRUE(damaged(bytes.substr(0, bytes.size() / 2)));
  EXPECT_TRUE(damaged(bytes + "x"));
  for (int i = 0; i < 4; ++i) {
    std::string other = bytes;
    // Among them sizes near the beginning.
    const std::size_t at = generator() % (i < 2 ? 200 : bytes.size());
    other[at] = static_cast<char>(other[at] ^ 0x41);
    EXPECT_TRUE(damaged(other)) << at;
  }
}

TEST_F(MeshShapeFile, SaysOnceWhereNothingCanBeKept) {
  write_file(folder_ / ".softfinger-cache", "a file where the folder should be");
  std::vector<std::string> messages;
  const MeshShape shape = load_mesh_shape(
      file_, {.edge_rounding = kRounding},
      {.progress = {}, .message = [&](const std::string& m) { messages.push_back(m); }});
  EXPECT_NEAR(shape->signed_distance({0, 0, 0.008}).distance, 0.003, 5e-5);
  EXPECT_THAT(messages, ElementsAre(HasSubstr("cannot be written")));
}

// Whoever runs it, root too, keeps nothing beside meshes that are the system's or somebody else's.
TEST_F(MeshShapeFile, IsKeptBesideMeshesOfTheUsersOwnAlone) {
  EXPECT_EQ(grid_cache_folder(file_), fs::canonical(folder_) / ".softfinger-cache");
  for (const char* foreign : {"/usr/local/share/softfinger/objects/relief.ply",
                              "/usr/share/softfinger/objects/relief.ply",
                              "/opt/softfinger/share/relief.ply", "/nowhere/relief.ply"}) {
    const EnvironmentVariable cache("XDG_CACHE_HOME", folder_ / "caches");
    EXPECT_EQ(grid_cache_folder(foreign), folder_ / "caches" / "softfinger") << foreign;
    const EnvironmentVariable none("XDG_CACHE_HOME", "");
    const EnvironmentVariable home("HOME", folder_);
    EXPECT_EQ(grid_cache_folder(foreign), folder_ / ".cache" / "softfinger") << foreign;
    const EnvironmentVariable homeless("HOME", "");
    EXPECT_EQ(grid_cache_folder(foreign), fs::path()) << foreign;
  }
  if (::geteuid() != 0) return;
  // The folder of another user, as root may well see it.
  ASSERT_EQ(::chown(folder_.c_str(), 65534, 65534), 0);
  const EnvironmentVariable cache("XDG_CACHE_HOME", folder_ / "caches");
  EXPECT_TRUE(builds());
  EXPECT_FALSE(builds());
  EXPECT_TRUE(kept().empty());
  EXPECT_FALSE(fs::is_empty(folder_ / "caches" / "softfinger"));
}

TEST_F(MeshShapeFile, KeepsNothingUnfinished) {
  EXPECT_TRUE(builds());
  for (const fs::path& file : kept()) EXPECT_EQ(file.extension(), ".grid");
}

TEST(MeshDrawing, HasAsManyTrianglesAsAskedAndTheSameShape) {
  const TriangleMesh mesh = torus_mesh(0.02, 0.008, 400, 200);
  EXPECT_EQ(drawing_of(mesh, 200000).triangles.size(), mesh.triangles.size());
  const TriangleMesh drawing = drawing_of(mesh, 10000);
  EXPECT_LE(drawing.triangles.size(), 10000u);
  EXPECT_GT(drawing.triangles.size(), 4000u);
  double volume = 0.0;
  for (const auto& t : drawing.triangles) {
    const auto at = [&](std::size_t k) -> const Vector3& {
      return drawing.positions[static_cast<std::size_t>(t[k])];
    };
    volume += at(0).cross(at(1)).dot(at(2)) / 6.0;
  }
  const double exact = 2.0 * M_PI * M_PI * 0.02 * 0.008 * 0.008;
  EXPECT_NEAR(volume, exact, 0.03 * exact);
}

}  // namespace
}  // namespace softfinger
