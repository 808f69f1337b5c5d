#include <cstring>
#include <vector>

#include "scratch_file.hpp"
#include "softfinger/base/hash.hpp"
#include "softfinger/geometry/grid_cache.hpp"
#include "softfinger/geometry/grid_sampling.hpp"

namespace {

using namespace softfinger;

const GridKey kKey{.source_hash = 1, .unit = 1e-3, .spacing = 0.5, .margin = 1.0};

/// A small complete cache file, as bytes.
std::vector<std::uint8_t> sound_cache() {
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const ClosedSurface surface = closed_surface(mesh, "mesh");
  SignedDistanceGrid::Content content =
      sample_distance(surface, TriangleTree(surface), kKey.spacing, kKey.margin, "mesh");
  content.drawing = mesh;
  const ScratchFile file("sound.grid");
  if (!write_grid_cache(file.path(), kKey, content)) __builtin_trap();
  return file.read();
}

/// As if whoever damaged the file had hashed it anew.
void seal(std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < 8) return;
  Hash hash;
  hash.add(std::span<const std::uint8_t>(bytes.data(), bytes.size() - 8));
  const std::uint64_t value = hash.value();
  std::memcpy(bytes.data() + bytes.size() - 8, &value, sizeof value);
}

}  // namespace

// Input: damage done to a sound cache, half of it among the sizes at its beginning.
extern "C" int fuzz_grid_cache(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::uint8_t> sound = sound_cache();
  static const ScratchFile file("damaged.grid");
  std::vector<std::uint8_t> bytes = damaged(sound, {data, size}, 256);
  seal(bytes);
  file.write(bytes);
  if (auto content = read_grid_cache(file.path(), kKey)) {
    const SignedDistanceGrid grid(std::move(*content), "mesh", 1);
    for (const double x : {-3.0, -0.4, 0.0, 0.9, 2.0, 1e9})
      (void)grid.signed_distance({x, 0.3, -x});
  }
  return 0;
}
