#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "geometry/generated_mesh.hpp"
#include "softfinger/base/hash.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/geometry/grid_cache.hpp"
#include "softfinger/geometry/grid_sampling.hpp"
#include "softfinger/threads/thread_clock.hpp"

// Signed distance of 120 skin samples to a mesh of a million triangles; thread CPU time. The
// baseline is the exact distance by the bounding volume hierarchy, in the same run; both answers
// are compared before either is timed.
namespace softfinger {
namespace {

constexpr int kPoints = 120;
constexpr int kFrames = 1000;

/// A sphere of radius 30 mm with bumps of 0.6 mm: an icosahedron, each edge divided by 224.
TriangleMesh bumpy_sphere() {
  TriangleMesh mesh = sphere_mesh(1.0, 224);
  for (Vector3& p : mesh.positions) {
    const Vector3 bumps = (14.0 * p).array().sin();
    p *= (30.0 + 0.6 * bumps.prod()) * mm;
  }
  return mesh;
}

/// The mesh with its tree and its grid; the grid is kept in the temporary folder for the next run.
struct Million {
  Million()
      : surface(closed_surface(bumpy_sphere(), "million")), tree(surface), grid(content(), "", 0) {}

  [[nodiscard]] SignedDistanceGrid::Content content() const {
    Hash hash;
    for (const Vector3& p : surface.mesh.positions) hash.add(p);
    const GridKey key{
        .source_hash = hash.value(), .unit = 1.0, .spacing = 0.125 * mm, .margin = 6.0 * mm};
    const auto file = grid_cache_file(
        std::filesystem::temp_directory_path() / "softfinger-benchmark-million", key);
    if (auto kept = read_grid_cache(file, key)) return std::move(*kept);
    SignedDistanceGrid::Content made =
        sample_distance(surface, tree, key.spacing, key.margin, "million");
    (void)write_grid_cache(file, key, made);
    return made;
  }

  ClosedSurface surface;
  TriangleTree tree;
  SignedDistanceGrid grid;
};

const Million& million() {
  static const Million mesh;
  return mesh;
}

/// A patch of skin samples, up to 0.3 mm off the surface, that strokes it by 0.1 mm a frame.
const std::vector<Vector3>& stroke() {
  static const std::vector<Vector3> points = [] {
    std::vector<Vector3> all;
    for (int f = 0; f < kFrames; ++f) {
      const double azimuth = 0.1 / 30.0 * f;
      const Vector3 centre(std::cos(azimuth), std::sin(azimuth), 0.2);
      for (int i = 0; i < kPoints; ++i) {
        const double angle = 2.39996323 * i;
        const double radius = 0.2 * std::sqrt((i + 0.5) / kPoints);
        const Vector3 d =
            (centre + radius * Vector3(-std::sin(azimuth) * std::cos(angle),
                                       std::cos(azimuth) * std::cos(angle), std::sin(angle)))
                .normalized();
        const Vector3 on = million().tree.closest(30.0 * mm * d).point;
        all.push_back(on + 0.3 * mm * std::sin(7.0 * i) * d);
      }
    }
    return all;
  }();
  return points;
}

/// Greatest difference of grid and tree over the stroke, um.
double greatest_difference() {
  static const double difference = [] {
    double worst = 0.0;
    for (const Vector3& p : stroke()) {
      worst = std::max(worst, std::abs(million().grid.signed_distance(p).distance -
                                       million().tree.closest(p).distance));
    }
    return worst;
  }();
  return difference / (1e-3 * mm);
}

template <typename Query>
void over_stroke(benchmark::State& state, Query&& query) {
  if (greatest_difference() > 1.0) {
    state.SkipWithError("grid and tree disagree by more than 1 um");
    return;
  }
  const std::vector<Vector3>& points = stroke();
  std::vector<double> times;
  std::size_t f = 0;
  for ([[maybe_unused]] auto unused : state) {
    const double start = thread_cpu_time();
    for (std::size_t i = f * kPoints; i < (f + 1) * kPoints; ++i) {
      benchmark::DoNotOptimize(query(points[i]));
    }
    times.push_back((thread_cpu_time() - start) / us);
    f = (f + 1) % kFrames;
  }
  std::sort(times.begin(), times.end());
  state.counters["median_us"] = times[times.size() / 2];
  state.counters["p99_us"] = times[times.size() * 99 / 100];
  state.counters["difference_um"] = greatest_difference();
}

void distance_120(benchmark::State& state, bool with_hessian) {
  const SignedDistanceGrid& grid = million().grid;
  over_stroke(state, [&](const Vector3& p) {
    return with_hessian ? grid.signed_distance(p) : grid.distance_and_gradient(p);
  });
  state.counters["memory_MB"] = static_cast<double>(grid.memory() >> 20);
}

void distance_120_tree(benchmark::State& state) {
  const TriangleTree& tree = million().tree;
  over_stroke(state, [&](const Vector3& p) { return tree.closest(p); });
}

BENCHMARK_CAPTURE(distance_120, gradient, false);
BENCHMARK_CAPTURE(distance_120, hessian, true);
BENCHMARK(distance_120_tree);

}  // namespace
}  // namespace softfinger
