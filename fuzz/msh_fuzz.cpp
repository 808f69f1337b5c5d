#include "scratch_file.hpp"
#include "softfinger/geometry/msh_file.hpp"

extern "C" int fuzz_msh(const std::uint8_t* data, std::size_t size) {
  static const softfinger::ScratchFile file("mesh.msh");
  file.write({data, size});
  softfinger::read_or_refuse([] { (void)softfinger::read_msh(file.path(), 1e-3); });
  return 0;
}
