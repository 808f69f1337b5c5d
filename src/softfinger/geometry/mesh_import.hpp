#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "softfinger/geometry/triangle_mesh.hpp"

namespace softfinger {

enum class MeshFormat { kObj, kStl, kPly, kGltf, kGlb };

/// "OBJ", "STL", ...
[[nodiscard]] const char* name_of(MeshFormat format);
/// By the file name's extension, in any case. Throws InputError for another one.
[[nodiscard]] MeshFormat mesh_format(const std::filesystem::path& file);

/// Content of files by name, as a mesh file names them; the first is the mesh file itself.
using MeshFiles = std::map<std::string, std::string>;

inline constexpr std::size_t kMostMeshBytes = std::size_t{1} << 30;
inline constexpr std::size_t kMostTriangles = 5'000'000;

/// Why a mesh could not be read; one line without the name of the file.
struct MeshRefusal {
  std::string message;
};

/// All triangles of all meshes of a file with their nodes' transforms, in the file's unit; polygons
/// are cut into triangles, points and lines left out. Only `files` are read, and `name` says which.
/// Throws MeshRefusal. The library behind it is known to crash on some broken files: see
/// import_mesh_apart().
[[nodiscard]] TriangleMesh import_mesh(MeshFormat format, const std::string& name,
                                       const MeshFiles& files);

/// How long an import may take.
struct ImportLimits {
  /// Of wall time; empty: ten times the processor time that its size allows.
  std::optional<std::chrono::milliseconds> longest;
  std::stop_token stop;  ///< asks for its end
};

/// The same in a process of its own with bounded time and memory, so that a broken file can only
/// break that. The process ends with the thread that called, and has no file of the program's open.
/// Throws MeshRefusal.
[[nodiscard]] TriangleMesh import_mesh_apart(MeshFormat format, const std::string& name,
                                             const MeshFiles& files,
                                             const ImportLimits& limits = {});

/// Refuses what headers announce but the file cannot hold, before anything is allocated for it.
/// Throws MeshRefusal.
void check_announced_sizes(MeshFormat format, const std::string& content);

}  // namespace softfinger
