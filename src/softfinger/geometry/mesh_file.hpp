#pragma once

#include <cstdint>
#include <filesystem>

#include "softfinger/geometry/mesh_import.hpp"

namespace softfinger {

/// A mesh file's bytes, those of the buffers it names (glTF) included.
struct MeshSource {
  std::filesystem::path file;
  MeshFormat format = MeshFormat::kObj;
  MeshFiles files;         ///< by name relative to the file's folder
  std::uint64_t hash = 0;  ///< of all of them (XXH64)
};

/// Reads an OBJ, STL, PLY, glTF or GLB file as it is. Throws InputError where it is missing,
/// unreadable, empty, larger than 1 GiB, or announces more than it has, and when `stop` asks for an
/// end.
[[nodiscard]] MeshSource read_mesh_source(const std::filesystem::path& file,
                                          const std::stop_token& stop = {});

/// Its triangles, welded, in m; `unit` is the file's, in m. Throws InputError where the file is
/// broken, has no triangles, more than 5,000,000 of them, or coordinates that are not finite, takes
/// too long, and when `stop` asks for an end.
[[nodiscard]] TriangleMesh triangles_of(const MeshSource& source, double unit,
                                        const std::stop_token& stop = {});

}  // namespace softfinger
