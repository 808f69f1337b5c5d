#include "softfinger/geometry/mesh_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "softfinger/base/stop_check.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/geometry/grid_cache.hpp"
#include "softfinger/geometry/grid_sampling.hpp"
#include "softfinger/geometry/mesh_drawing.hpp"
#include "softfinger/geometry/mesh_file.hpp"
#include "softfinger/geometry/surface_check.hpp"

namespace softfinger {
namespace {

/// Of the domain beyond the mesh.
constexpr double kMargin = 6.0 * mm;
/// Of the grid's spacing: with two, edges of up to 140 degrees are rounded by less than an arc of
/// that radius would.
constexpr double kSpacingsPerRounding = 2.0;
constexpr std::size_t kMostDrawn = 60'000;

/// The stretch [begin, end] of the whole work.
Progress stretch(const Progress& whole, double begin, double end) {
  if (!whole) return {};
  return [&whole, begin, end](double fraction) { whole(begin + (end - begin) * fraction); };
}

SignedDistanceGrid::Content build(const MeshSource& source, const GridKey& key,
                                  const LoadObserver& observer) {
  const std::string name = source.file.string();
  // Work that tells how far it is can be ended there.
  const Progress progress = [&](double fraction) {
    StopCheck::now(observer.stop);
    if (observer.progress) observer.progress(fraction);
  };
  const ClosedSurface surface =
      closed_surface(triangles_of(source, key.unit, observer.stop), name, observer.stop);
  const TriangleTree tree(surface, observer.stop);
  check_surface(surface, tree, name, stretch(progress, 0.1, 0.2));
  SignedDistanceGrid::Content content =
      sample_distance(surface, tree, key.spacing, key.margin, name, stretch(progress, 0.2, 1.0));
  content.drawing = drawing_of(surface.mesh, kMostDrawn, observer.stop);
  return content;
}

}  // namespace

std::shared_ptr<const SignedDistanceGrid> load_mesh_shape(const std::filesystem::path& file,
                                                          const MeshShapeOptions& options,
                                                          const LoadObserver& observer) {
  const MeshSource source = read_mesh_source(file, observer.stop);
  const GridKey key{source.hash, options.unit, options.edge_rounding / kSpacingsPerRounding,
                    kMargin};
  const std::filesystem::path cache = grid_cache_file(file, key);
  if (options.use_cache) {
    if (auto kept = read_grid_cache(cache, key, observer.stop)) {
      return std::make_shared<SignedDistanceGrid>(std::move(*kept), file, source.hash);
    }
  }
  SignedDistanceGrid::Content content = build(source, key, observer);
  if (observer.progress) observer.progress(1.0);
  const bool kept = !options.use_cache || write_grid_cache(cache, key, content, observer.stop);
  if (!kept && observer.message) {
    observer.message(
        cache.empty()
            ? fmt::format("there is no folder for caches (HOME, XDG_CACHE_HOME), so the distance "
                          "grid of {} is not kept",
                          file.filename().string())
            : fmt::format("{}: cannot be written, so the distance grid of {} is not kept",
                          cache.parent_path().string(), file.filename().string()));
  }
  return std::make_shared<SignedDistanceGrid>(std::move(content), file, source.hash);
}

}  // namespace softfinger
