#include "scratch_file.hpp"

#include <unistd.h>

#include <fstream>
#include <string>

namespace softfinger {

ScratchFile::ScratchFile(std::string_view name)
    : folder_(std::filesystem::path("/dev/shm") / ("softfinger-fuzz-" + std::to_string(getpid()))),
      path_(folder_ / name) {
  std::filesystem::create_directories(folder_);
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void ScratchFile::write(std::span<const std::uint8_t> bytes) const {
  std::ofstream out(path_, std::ios::binary | std::ios::trunc);
  for (const std::uint8_t byte : bytes) out.put(static_cast<char>(byte));
}

}  // namespace softfinger
