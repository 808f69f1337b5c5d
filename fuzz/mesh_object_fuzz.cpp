#include <algorithm>
#include <array>
#include <memory>

#include "scratch_file.hpp"
#include "softfinger/geometry/grid_sampling.hpp"
#include "softfinger/geometry/mesh_file.hpp"
#include "softfinger/geometry/surface_check.hpp"

// Input: which format (1 byte), then the file. What is accepted becomes a coarse grid.
extern "C" int fuzz_mesh_object(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  static const std::array<std::unique_ptr<ScratchFile>, 5> files{
      std::make_unique<ScratchFile>("mesh.obj"), std::make_unique<ScratchFile>("mesh.stl"),
      std::make_unique<ScratchFile>("mesh.ply"), std::make_unique<ScratchFile>("mesh.gltf"),
      std::make_unique<ScratchFile>("mesh.glb")};
  if (size < 1) return 0;
  const ScratchFile& file = *files[data[0] % files.size()];
  file.write({data + 1, size - 1});
  read_or_refuse([&] {
    const ClosedSurface surface =
        closed_surface(triangles_of(read_mesh_source(file.path()), 1e-3), "mesh");
    const TriangleTree tree(surface);
    check_surface(surface, tree, "mesh");
    Eigen::AlignedBox3d bounds;
    for (const Vector3& p : surface.mesh.positions) bounds.extend(p);
    const double span = bounds.diagonal().norm();
    (void)sample_distance(surface, tree, 0.05 * span, 0.1 * span, "mesh");
  });
  return 0;
}
