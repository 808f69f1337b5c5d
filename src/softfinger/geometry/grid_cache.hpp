#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>

#include "softfinger/geometry/signed_distance_grid.hpp"

namespace softfinger {

/// What a cached grid was made from: a grid is used only where all of this is the same.
struct GridKey {
  std::uint64_t source_hash = 0;  ///< of the mesh file's content
  double unit = 0.0;              ///< of its coordinates, m
  double spacing = 0.0;           ///< m
  double margin = 0.0;            ///< m
};

/// The folder for grids of a mesh file: `.softfinger-cache` beside it where that folder is the
/// user's own, else the user's folder for caches: `softfinger` in $XDG_CACHE_HOME or ~/.cache.
/// Empty: there is none.
[[nodiscard]] std::filesystem::path grid_cache_folder(const std::filesystem::path& mesh_file);

/// Where the grid of a mesh file is kept, by name and key; empty: nowhere.
[[nodiscard]] std::filesystem::path grid_cache_file(const std::filesystem::path& mesh_file,
                                                    const GridKey& key);

/// A grid kept for this key; empty where there is none, or what is there is damaged or another's.
/// Throws InputError when `stop` asks for an end.
[[nodiscard]] std::optional<SignedDistanceGrid::Content> read_grid_cache(
    const std::filesystem::path& file, const GridKey& key, const std::stop_token& stop = {});

/// Writes it in one go: whoever reads at the same time sees the old file or the new one. False
/// where it cannot be written. Throws InputError when `stop` asks for an end, and leaves nothing.
[[nodiscard]] bool write_grid_cache(const std::filesystem::path& file, const GridKey& key,
                                    const SignedDistanceGrid::Content& content,
                                    const std::stop_token& stop = {});

}  // namespace softfinger
