#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "softfinger/geometry/signed_distance_grid.hpp"
#include "softfinger/threads/parallel_for.hpp"

namespace softfinger {

struct MeshShapeOptions {
  double unit = 1e-3;              ///< of the file's coordinates, m
  double edge_rounding = 0.25e-3;  ///< largest radius by which features are rounded, m
  bool use_cache = true;           ///< keep the grid, see grid_cache_folder()
};

/// Told what long loading does.
struct LoadObserver {
  Progress progress;
  std::function<void(const std::string&)> message;  ///< one line for people
  /// Asks for its end, soon and with an InputError, where a mesh is being loaded.
  std::stop_token stop = {};
};

/// The solid a mesh file encloses, as a grid of signed distances: taken from the cache where it has
/// one for this content and these options, else built on all cores and kept there. Throws
/// InputError where the file cannot be read or its surface encloses no solid.
[[nodiscard]] std::shared_ptr<const SignedDistanceGrid> load_mesh_shape(
    const std::filesystem::path& file, const MeshShapeOptions& options,
    const LoadObserver& observer = {});

}  // namespace softfinger
