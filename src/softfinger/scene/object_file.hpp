#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/geometry/mesh_shape.hpp"

namespace softfinger {

/// An `[[object]]` of a scene file as its table says, but for what its mesh and other objects tell.
struct ReadObject {
  /// Loaded once the scene file is known to be right; until then the object is a plane.
  struct Mesh {
    std::filesystem::path file;
    MeshShapeOptions options;
  };
  ConfigTable table;
  VirtualObject object;
  std::optional<Mesh> mesh;
  std::optional<double> density;  ///< instead of a mass, kg/m^3
};

/// Throws InputError with file, line and key, as the others do. Without `with_files` tetrahedra of
/// soft objects are left out.
[[nodiscard]] std::vector<ReadObject> read_objects(const std::vector<ConfigTable>& tables,
                                                   bool with_files = true);

/// Objects with their parents, meshes and masses; objects of the same mesh share it.
[[nodiscard]] std::vector<VirtualObject> complete(const std::vector<ReadObject>& read,
                                                  const LoadObserver& observer);

}  // namespace softfinger
