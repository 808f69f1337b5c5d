#include "scratch_file.hpp"
#include "softfinger/device/device_file.hpp"

extern "C" int fuzz_device(const std::uint8_t* data, std::size_t size) {
  static const softfinger::ScratchFile file("device.toml");
  file.write({data, size});
  softfinger::read_or_refuse([] { (void)softfinger::load_device(file.path()); });
  return 0;
}
