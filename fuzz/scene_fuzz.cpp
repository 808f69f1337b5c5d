#include "scratch_file.hpp"
#include "softfinger/scene/scene.hpp"

extern "C" int fuzz_scene(const std::uint8_t* data, std::size_t size) {
  static const softfinger::ScratchFile file("scene.toml");
  file.write({data, size});
  softfinger::read_or_refuse([] { (void)softfinger::load_scene(file.path()); });
  return 0;
}
