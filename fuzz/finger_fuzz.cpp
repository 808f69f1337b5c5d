#include "../tests/support/folders.hpp"
#include "scratch_file.hpp"
#include "softfinger/finger/finger_model.hpp"

extern "C" int fuzz_finger(const std::uint8_t* data, std::size_t size) {
  static const softfinger::ScratchFile file("finger.toml");
  // The mesh that the seed names lies beside it, so that constants are reached behind it.
  [[maybe_unused]] static const bool copied = std::filesystem::copy_file(
      softfinger::source_folder() + "/fingers/index.msh", file.path().parent_path() / "index.msh");
  file.write({data, size});
  softfinger::read_or_refuse([] { (void)softfinger::FingerModel::load(file.path()); });
  return 0;
}
